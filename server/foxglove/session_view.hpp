#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "core/landmarks/landmark_map.hpp"
#include "core/localization/session_poses.hpp"
#include "core/mapping/snapshot.hpp"

#include <cstdint>
#include <memory>
#include <optional>
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
    std::shared_ptr<const localization::PoseGraphView> graph = nullptr; ///< null: not known yet
    std::uint64_t graph_version = 0;                                    ///< increases when `graph` changes
};

} // namespace scanloom::foxglove
