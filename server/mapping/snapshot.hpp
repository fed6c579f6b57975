#pragma once

#include "common/scan/exclusions.hpp"
#include "server/classify/cell_class.hpp"
#include "server/grid/cell.hpp"
#include "server/mapping/laser_layers.hpp"
#include "server/mapping/layer.hpp"
#include "server/mapping/map_config.hpp"
#include "server/mapping/sonar_layer.hpp"
#include "server/mapping/trajectory.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::mapping {

/// A scan that was applied, with its sensor's description at that time.
struct FoldedScan {
    Revision revision = 0; ///< of the scan's log entry
    std::shared_ptr<const Sensor> sensor;
    Scan scan;
};

/// The state of one robot. Its index in Snapshot::robots is its RobotIndex.
struct RobotState {
    std::string name;
    std::optional<double> body_radius; ///< metres, as stated when the robot last joined
    std::uint64_t last_seq = 0;
    std::uint64_t scan_count = 0; ///< integrated
    std::uint64_t jumps = 0;      ///< scans that max_jump left out
    std::uint64_t excluded = 0;   ///< scans that exclusions left out
    double stamp = 0.0;           ///< seconds, of the newest integrated scan
    std::optional<Pose2> pose;    ///< T_map_robot of the newest integrated scan
    TrajectoryView trajectory;

    /// For display only, not part of the maps. Set only in a session that accepts scans, to a scan received since the
    /// session was loaded.
    std::shared_ptr<const FoldedScan> newest_scan;
};

/// Boxes around the cells of each layer that any scan changed.
struct LayerBounds {
    LaserLayers::Bounds laser;
    grid::CellBox sonar;

    friend bool operator==(const LayerBounds&, const LayerBounds&) = default;
};

/// Returns the box of cells that any layer has observed.
[[nodiscard]] grid::CellBox bounds_of(const LayerBounds& bounds) noexcept;

/// The maps of a session at one revision, shared by all readers. Immutable; hold it by shared_ptr<const Snapshot> as
/// long as needed.
struct Snapshot {
    Revision revision = 0;
    MapConfig config;
    SharedExclusions exclusions = no_exclusions(); ///< of the session's log
    LayerBounds bounds;
    std::size_t chunk_count = 0; ///< of laser and sonar layers
    LaserView laser;
    SonarView sonar;
    classify::ClassView classes;
    std::vector<RobotState> robots;
};

/// Returns the box of cells that a layer shows.
[[nodiscard]] grid::CellBox bounds_of(const Snapshot& snapshot, Layer layer) noexcept;

/// Returns the box of cells that any layer has observed.
[[nodiscard]] inline grid::CellBox bounds_of(const Snapshot& snapshot) noexcept { return bounds_of(snapshot.bounds); }

} // namespace scanloom::mapping
