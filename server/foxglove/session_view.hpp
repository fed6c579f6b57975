#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "core/landmarks/landmark_map.hpp"
#include "core/localization/session_poses.hpp"
#include "core/mapping/snapshot.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::foxglove {

/// What a robot does next. Metres, map frame.
struct Guided {
    RobotIndex robot = 0;
    std::optional<Point2> goal; ///< where it should stand; nullopt: it has no goal
    std::vector<Point2> path;   ///< empty: none
};

/// The state of a session that viewers see.
struct SessionView {
    std::shared_ptr<const mapping::Snapshot> maps;                      ///< not null
    std::vector<bool> connected;                                        ///< by RobotIndex
    std::vector<Guided> guided;                                         ///< robots with a goal or a path
    std::uint64_t guided_version = 0;                                   ///< increases when `guided` changes
    std::optional<landmarks::LandmarkView> landmarks;                   ///< nullopt: not known yet
    Revision landmarks_revision = 0;                                    ///< searched log entries
    std::shared_ptr<const std::string> map = nullptr;                   ///< as a grid_message(); null: there is none
    bool is_map_too_large = false;                                      ///< to be sent as one grid
    std::shared_ptr<const std::string> frontiers = nullptr;             ///< as a frontiers_message(); null: not known
    std::shared_ptr<const localization::PoseGraphView> graph = nullptr; ///< null: not known
    Revision parts_revision = 0; ///< of the maps that `map`, `frontiers` and `graph` are computed from
};

/// Returns the newest stamp of any robot, in seconds.
[[nodiscard]] inline double newest_stamp(const mapping::Snapshot& maps) {
    double newest = 0.0;
    for (const mapping::RobotState& robot : maps.robots) newest = std::max(newest, robot.stamp);
    return newest;
}

} // namespace scanloom::foxglove
