#pragma once

#include "common/error/error.hpp"
#include "core/landmarks/alignment.hpp"
#include "core/landmarks/reference_map.hpp"

#include <functional>
#include <optional>
#include <span>

namespace scanloom::landmarks {

/// What a sensor saw from one place, in some turns.
struct CloudView {
    std::span<const Point2> points; ///< metres, in any frame
    Point2 from{0.0, 0.0};          ///< position of the sensor, in that frame
};

/// A part of the map: a square around its middle.
struct Neighbourhood {
    Point2 middle{0.0, 0.0}; ///< metres, map frame
    double radius = 0.0;     ///< metres from the middle to each side, more than 0
};

/// Finds the pose of a view in a map, without an initial guess.
///
/// Searches all poses everywhere that robots have looked, refines the best hypotheses, and tests them against what the
/// map's views and this view saw, and against the free space that they observed. T_first_second of the result takes the
/// view's frame to the map's. The result is clear only if no other place of the map, or of the neighbourhood, has
/// nearly as many inliers. `inlier_ratio` is the fraction of the view that is in the map.
/// @param map   keyframes of a session; see ReferenceLayer
/// @param view  what the robot sees
/// @param near  the part of the map to search; nullopt: the whole map
/// @param ask   called from time to time, because a search in a large map may take seconds; an error that it returns
///     ends the search
/// Errors: kNothingMapped if no laser has seen anything anywhere; kTooLarge if the map is more than 200 m wide and no
///     neighbourhood limits the search; kInvalidField if a point or the sensor position is invalid (see
///     check_points()), or if the view has fewer than kViewPointsMin points; those of `ask`.
/// Cost: for each of about 100 rotations the surface elements of the map times 250, and some tens of milliseconds.
/// Source: see find_hypotheses(), refine_by_icp(), fit_to_lines() and test_acceptance().
[[nodiscard]] Result<Alignment> locate(
    const ReferenceViews& map, const CloudView& view, const std::optional<Neighbourhood>& near = {},
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
