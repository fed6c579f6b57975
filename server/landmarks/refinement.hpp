#pragma once

#include "server/landmarks/alignment_surfels.hpp"
#include "server/landmarks/point_tree.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A surface, and what of it is nearest to a place.
class Surface {
public:
    explicit Surface(std::vector<Surfel> surfels) : surfels_(std::move(surfels)), tree_(positions_of(surfels_)) {}

    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }
    /// The nearest surface element. Pre  there is one.
    [[nodiscard]] Neighbor nearest(const Point2& place) const { return *tree_.nearest(place); }

private:
    std::vector<Surfel> surfels_;
    PointTree tree_;
};

/// Brings a second surface nearer to the first, from a pose that is off by up to half a metre and some degrees:
/// iterated closest points, of which only the closer part counts, as not all that one sees the other does.
/// @param T_first_second  where to begin
/// @return where it came to rest, or after some steps; the start, where nothing is close
/// Pre     both have surface elements.
/// Source  Besl, McKay, A method for registration of 3-D shapes (1992); Chetverikov et al., The trimmed iterative closest
///         point algorithm (2002).
[[nodiscard]] Pose2 settle(const Surface& first, std::span<const Surfel> second, const Pose2& T_first_second);

/// What fitting two surfaces to each other's lines came to.
struct LineFit {
    Pose2 T_first_second;
    double agreement = 0.0;                                  ///< the more elements are on lines, the more
    std::size_t used = 0;                                    ///< elements of both that took part
    double rms = 0.0;                                        ///< metres, of their distances from the other's lines
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero(); ///< of the residuals by (x, y, yaw)
};

/// Slides the second surface onto the first, from a pose that is off by a few centimetres, so that each surface's
/// elements come to lie on the lines of the other's. Along a wall nothing holds it: density and spacing of the points
/// do not matter. What no line holds stays where it is.
/// Pre     both have surface elements.
/// Source  Censi, An ICP variant using a point-to-line metric (2008), both ways; Gauss-Newton, with Tukey's biweight.
[[nodiscard]] LineFit fit_to_lines(const Surface& first, const Surface& second, const Pose2& T_first_second);

} // namespace scanloom::landmarks
