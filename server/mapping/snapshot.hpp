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

/// A scan as it was folded, with the description that its sensor had then.
struct FoldedScan {
    Revision revision = 0; ///< of its log entry
    std::shared_ptr<const Sensor> sensor;
    Scan scan;
};

/// What a session knows of one robot. Its place in Snapshot::robots is its RobotIndex.
struct RobotState {
    std::string name;
    std::optional<double> body_radius; ///< metres, as it stated when it joined last
    std::uint64_t last_seq = 0;
    std::uint64_t scan_count = 0; ///< integrated
    std::uint64_t jumps = 0;      ///< scans that max_jump left out
    std::uint64_t excluded = 0;   ///< scans that exclusions left out
    double stamp = 0.0;           ///< seconds, of the newest integrated scan
    std::optional<Pose2> pose;    ///< T_map_robot of the newest integrated scan
    TrajectoryView trajectory;

    /// To be looked at, no part of the maps: only a session that takes scans has it, of scans taken since it was
    /// loaded.
    std::shared_ptr<const FoldedScan> newest_scan;
};

/// The cells of each layer that any scan changed.
struct LayerBounds {
    LaserLayers::Bounds laser;
    grid::CellBox sonar;

    friend bool operator==(const LayerBounds&, const LayerBounds&) = default;
};

/// The cells in which any layer shows what a sensor saw.
[[nodiscard]] grid::CellBox bounds_of(const LayerBounds& bounds) noexcept;

/// Everything a session has woven from its log up to one revision: what all readers read.
/// Immutable; hold it by shared_ptr<const Snapshot> as long as needed.
struct Snapshot {
    Revision revision = 0;
    MapConfig config;
    SharedExclusions exclusions = no_exclusions(); ///< of its log
    LayerBounds bounds;
    std::size_t chunk_count = 0; ///< of lasers and sonars
    LaserView laser;
    SonarView sonar;
    classify::ClassView classes;
    std::vector<RobotState> robots;
};

/// The cells in which a layer shows anything.
[[nodiscard]] grid::CellBox bounds_of(const Snapshot& snapshot, Layer layer) noexcept;

[[nodiscard]] inline grid::CellBox bounds_of(const Snapshot& snapshot) noexcept { return bounds_of(snapshot.bounds); }

} // namespace scanloom::mapping
