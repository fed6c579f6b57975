#pragma once

#include "core/landmarks/alignment_surfels.hpp"
#include "core/landmarks/point_index.hpp"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// Surface elements with a search for the nearest one.
class Surface {
public:
    /// Builds the search index of surface elements.
    explicit Surface(std::vector<Surfel> surfels) : surfels_(std::move(surfels)), tree_(positions_of(surfels_)) {}

    /// Returns the surface elements.
    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }
    /// Returns the surface element nearest to a place, or nullopt if it is farther than `radius` away.
    /// @param place   metres, in the frame of the elements
    /// @param radius  metres
    [[nodiscard]] std::optional<Neighbor> nearest_within(const Point2& place, double radius) const {
        return tree_.nearest_within(place, radius);
    }

private:
    std::vector<Surfel> surfels_;
    PointTree tree_;
};

/// The positions of one place in two frames.
struct PointPair {
    Point2 first{0.0, 0.0};  ///< metres, in the first frame
    Point2 second{0.0, 0.0}; ///< metres, in the second frame
};

/// Computes the rotation and translation, never a reflection, that minimize the sum of squared distances between each
/// first point and the transformed second point.
///
/// Two pairs are enough, and so are pairs on one line: in the plane only a reflection would fit those as well.
/// @param pairs  positions, metres
/// @return T_first_second, or nullopt if it is not determined: there are fewer than 2 pairs, all points of one side are
///     equal, or any rotation fits as well
/// Precondition: the points pass check_points().
/// Source: Umeyama, Least-squares estimation of transformation parameters between two point patterns (1991); in the
///     plane the rotation is the direction of the sum of conj(second) * first, both relative to their centroids.
[[nodiscard]] std::optional<Pose2> align_pairs(std::span<const PointPair> pairs);

/// Refines a pose that is off by up to half a metre and some degrees, by iterated closest points. Only the closer part
/// of the pairs counts, because one view does not show everything that the other shows.
/// @param first           surface in the first frame
/// @param second          surface elements in the second frame
/// @param T_first_second  the pose to refine
/// @return the pose at convergence or after the last step; T_first_second if nothing is close
/// Precondition: both have surface elements.
/// Source: Besl, McKay, A method for registration of 3-D shapes (1992); Chetverikov et al., The trimmed iterative
///     closest point algorithm (2002).
[[nodiscard]] Pose2 refine_by_icp(const Surface& first, std::span<const Surfel> second, const Pose2& T_first_second);

/// The result of fit_to_lines().
struct LineFit {
    Pose2 T_first_second;                                    ///< the refined pose: metres, radians
    double agreement = 0.0;                                  ///< increases with the number of elements on lines
    std::size_t used = 0;                                    ///< elements of both surfaces that were used
    double rms = 0.0;                                        ///< metres, of their distances from the other's lines
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero(); ///< of the residuals by (x, y, yaw)
};

/// Refines a pose that is off by a few centimetres, so that each surface's elements lie on the lines of the other.
///
/// Elements can slide along a line, so the density and spacing of the points do not matter. The pose does not change in
/// directions that no line constrains.
/// @param first           surface in the first frame
/// @param second          surface in the second frame
/// @param T_first_second  the pose to refine
/// Precondition: both have surface elements.
/// Source: Censi, An ICP variant using a point-to-line metric (2008), in both directions; Gauss-Newton with Tukey's
///     biweight.
[[nodiscard]] LineFit fit_to_lines(const Surface& first, const Surface& second, const Pose2& T_first_second);

} // namespace scanloom::landmarks
