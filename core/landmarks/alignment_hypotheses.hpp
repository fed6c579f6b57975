#pragma once

#include "common/error/error.hpp"
#include "core/landmarks/alignment_evidence.hpp"
#include "core/landmarks/alignment_surfels.hpp"
#include "core/landmarks/refinement.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::size_t kSurfelsMax = 250; ///< surface elements of a view that vote

/// Returns at most count_max surface elements, chosen evenly among the cloud's rows.
/// @param surfels    ordered by rows; see surfels_of()
/// @param count_max  at least 1
[[nodiscard]] std::vector<Surfel> sample(std::span<const Surfel> surfels, std::size_t count_max);

/// Searches the poses in which two surfaces may match, the likeliest first.
///
/// For each of evenly spaced rotations, every pair of surface elements of similar direction votes for the translation
/// that moves one onto the other. Maxima of the votes are hypotheses. So the search needs no initial guess, and also
/// finds the other poses that may be correct. Hypotheses are distinct and not refined: a good one is within about 0.2 m
/// and 3 degrees of the pose it represents.
/// @param first         surface elements in the first frame
/// @param second        surface elements in the second frame
/// @param distance_max  metres from the first frame's origin to the second's, along each axis
/// @param count_max     at most this many hypotheses are returned
/// @param first_max     at most this many surface elements of the first surface are used, evenly chosen; of the second
///     kSurfelsMax
/// @param ask           called before each rotation; an error that it returns ends the search
/// @return T_first_second of each hypothesis
/// Errors: those of `ask`.
/// Cost: the number of rotations times the number of pairs of elements used.
/// Source: Ballard, Generalizing the Hough transform to detect arbitrary shapes (1981); Olson, Real-time correlative
///     scan matching (2009), for the exhaustive search.
[[nodiscard]] Result<std::vector<Pose2>> find_hypotheses(
    std::span<const Surfel> first, std::span<const Surfel> second, double distance_max, std::size_t count_max,
    std::size_t first_max, const std::function<Result<>()>& ask = [] { return Result<>(); });

/// Searches the translations for one rotation, as find_hypotheses() does. If things repeat, it finds most of the places
/// that may be confused.
/// @param first         surface elements in the first frame
/// @param second        surface elements in the second frame
/// @param yaw           radians, rotation of the second surface
/// @param distance_max  metres from the first frame's origin to the second's, along each axis
/// @param count_max     at most this many poses are returned
/// @param first_max     at most this many surface elements of the first surface are used
/// @return T_first_second of each hypothesis
[[nodiscard]] std::vector<Pose2> find_translations(std::span<const Surfel> first, std::span<const Surfel> second,
                                                   double yaw, double distance_max, std::size_t count_max,
                                                   std::size_t first_max);

/// A surface that was seen from one or several places, in one frame, to match others against.
struct Seen {
    Surface surface;                      ///< metres, in the frame of the horizons
    std::vector<const Horizon*> horizons; ///< of the places it was seen from; must outlive this object
};

/// The direction in which lines constrain a pose least, and how much they constrain it, relative to the elements used.
struct WeakDirection {
    Point2 direction;  ///< unit vector, in the first frame
    double constraint; ///< smallest eigenvalue of the position's normal matrix, per element; 0: not at all
};
/// Returns the direction in which the lines of a fit constrain the position least.
/// @param fit  result of fit_to_lines()
[[nodiscard]] WeakDirection weak_direction(const LineFit& fit);

/// Returns whether two poses are different results: they are more than 0.1 m or 3 degrees apart.
/// @param a  metres, radians
/// @param b  in the same frame
[[nodiscard]] bool is_distinct(const Pose2& a, const Pose2& b);

/// A refined hypothesis and its evidence.
struct Candidate {
    LineFit fit;              ///< the pose and how well it fits
    Evidence second_in_first; ///< elements of the view, seen by the map
    Evidence first_in_second; ///< elements of the map around the view, seen by the view

    /// Returns T_first_second.
    [[nodiscard]] const Pose2& pose() const { return fit.T_first_second; }
    /// Returns the evidence of both directions together.
    [[nodiscard]] Evidence both() const { return second_in_first + first_in_second; }
    /// Returns twice the number of the view's inliers, minus the weighted number of all outliers. The map's elements do
    /// not count as inliers, because a wall that was seen more often has more elements than its length.
    [[nodiscard]] double score() const;
};

/// Refines a hypothesis and collects its evidence.
/// @param first   surface and horizons in the first frame
/// @param second  surface and horizons in the second frame
/// @param start   a pose that is off by a few centimetres; see refine_by_icp()
/// Precondition: both have surface elements; the origin of the second's frame is the position it was seen from.
[[nodiscard]] Candidate make_candidate(const Seen& first, const Seen& second, const Pose2& start);

/// Returns the best candidate and the few others that are distinct and nearly as good. Each may become the correct pose
/// when it is shifted; see add_shifted().
/// @param candidates  in any order
[[nodiscard]] std::vector<Candidate> likely_candidates(std::vector<Candidate> candidates);

/// Adds the candidates that result from shifting `best` along its weakest direction, because refinement in a
/// corridor stops wherever something is near.
/// @param first       surface and horizons in the first frame
/// @param second      surface and horizons in the second frame
/// @param best        its pose is shifted
/// @param candidates  extended
void add_shifted(const Seen& first, const Seen& second, const Candidate& best, std::vector<Candidate>& candidates);

/// Sorts candidates by score, the best first. Of the candidates that are not distinct from the best, the one that fits
/// best comes first.
void rank(std::vector<Candidate>& candidates);

} // namespace scanloom::landmarks
