#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/mapping/snapshot.hpp"
#include "core/planning/coverage.hpp"
#include "core/planning/grid_path.hpp"
#include "server/sessions/session_registry.hpp"

#include <optional>
#include <vector>

/// Plans paths by the same rules for the HTTP API and for the requests of robots.
namespace scanloom::guidance {

/// The start of a path.
struct Start {
    Point2 point;                           ///< metres, map frame
    std::optional<double> body_radius = {}; ///< metres; of the robot, if it stated one
};

/// Returns the start of a robot's path.
/// @param point  metres, map frame; nullopt: the position of the robot's newest scan
/// Errors: those of pose_of() if `point` is not given.
[[nodiscard]] Result<Start> start_of(const mapping::Snapshot& maps, RobotIndex robot,
                                     const std::optional<Point2>& point = {});

/// The members of a request that describe the body and where it may go. The planner checks the ranges.
struct RequestedBody {
    std::optional<double> radius = {};      ///< metres; nullopt: that of the robot
    bool allow_unknown = false;             ///< see planning::PassabilityOptions
    std::optional<double> danger_cost = {}; ///< nullopt: the default
};

/// Returns the options for a body. Unless unknown ground is allowed, the whole body must be on known ground.
/// @param own  the robot's body radius (m), if known; used if the request has none
[[nodiscard]] planning::PassabilityOptions passability_of(const RequestedBody& requested,
                                                          const std::optional<double>& own);

/// Plans the cheapest path.
/// @param to  metres, map frame
/// Errors: those of planning::plan_path().
[[nodiscard]] Result<planning::Path> plan_path(const mapping::Snapshot& maps, const Start& start, const Point2& to,
                                               const RequestedBody& body);

/// The area that a path is to cover, and how.
struct CoverageRequest {
    std::optional<double> body_radius; ///< metres; nullopt: that of the robot
    std::optional<double> spacing;     ///< metres between rows; see planning::CoverageOptions
    std::vector<Point2> region;        ///< corners of a polygon, metres, map frame; empty: no bound
};

/// Plans a path that covers a region, within the time of a SearchLimit.
/// Errors: those of planning::plan_coverage() and SearchLimit.
[[nodiscard]] Result<planning::Coverage> plan_coverage(const mapping::Snapshot& maps, const Start& start,
                                                       CoverageRequest request,
                                                       const sessions::SessionRegistry& sessions);

} // namespace scanloom::guidance
