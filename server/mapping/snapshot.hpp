#pragma once

#include "common/scan/log_entry.hpp"
#include "server/grid/cell.hpp"
#include "server/mapping/map_config.hpp"
#include "server/mapping/occupancy_layer.hpp"
#include "server/mapping/trajectory.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::mapping {

/// What a session knows of one robot. Its place in Snapshot::robots is its RobotIndex.
struct RobotState {
    std::string name;
    std::uint64_t last_seq = 0;
    std::uint64_t scan_count = 0;
    double stamp = 0.0;        ///< seconds, of the newest scan
    std::optional<Pose2> pose; ///< T_map_robot of the newest scan
    TrajectoryView trajectory;
};

/// Everything a session has woven from its log up to one revision: what all readers read.
/// Immutable; hold it by shared_ptr<const Snapshot> as long as needed.
struct Snapshot {
    Revision revision = 0;
    MapConfig config;
    grid::CellBox bounds; ///< cells that any scan changed
    OccupancyView occupancy;
    std::vector<RobotState> robots;
};

} // namespace scanloom::mapping
