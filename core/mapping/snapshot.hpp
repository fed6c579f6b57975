#pragma once

#include "common/scan/poses.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/classify/cell_class.hpp"
#include "core/grid/cell.hpp"
#include "core/mapping/laser_layers.hpp"
#include "core/mapping/layer.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/scan_poses.hpp"
#include "core/mapping/sonar_layer.hpp"
#include "core/mapping/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::mapping {

/// A scan that was applied, with its sensor's description at that time.
struct IntegratedScan {
    Revision revision = 0;                ///< of the scan's log entry
    std::shared_ptr<const Sensor> sensor; ///< not null
    Scan scan;                            ///< as in the log, with the pose at which it was integrated
};

/// How well the poses of a robot are known.
struct Localization {
    LocalizationState state = LocalizationState::kGiven; ///< in one word
    double inlier_ratio = 0.0;                           ///< of the newest scan's points, those that fit the map
    double position_sigma = 0.0;           ///< metres, of the newest pose, in the most uncertain direction
    double yaw_sigma = 0.0;                ///< radians, of the newest pose
    std::size_t loops = 0;                 ///< edges to parts of the map that were made earlier
    std::size_t corrections = 0;           ///< of the poses of earlier scans in the maps
    std::optional<double> mount_yaw_error; ///< radians: by how much the yaw of the laser's mount seems to be too large
};

/// The state of one robot. Its index in Snapshot::robots is its RobotIndex.
struct RobotState {
    std::string name;                  ///< unique within the session
    std::optional<double> body_radius; ///< metres, as stated when the robot last joined
    Poses poses = Poses::kMap;         ///< what the robot knows of its poses
    std::uint64_t last_seq = 0;        ///< of its newest scan in the log; 0 if it has none
    std::uint64_t scan_count = 0;      ///< scans in the trajectory
    std::uint64_t jumps = 0;           ///< scans that max_jump left out
    std::uint64_t excluded = 0;        ///< scans that exclusions left out
    std::uint64_t unplaced = 0;        ///< scans left out because their poses are not known
    double stamp = 0.0;                ///< seconds, of the newest integrated scan
    std::optional<Pose2> pose;         ///< T_map_robot of the newest integrated scan
    TrajectoryView trajectory;         ///< of its integrated scans

    /// For display only, not part of the maps. Set only in a session that accepts scans, to a scan received since the
    /// session was loaded.
    std::shared_ptr<const IntegratedScan> newest_scan;
    std::vector<std::shared_ptr<const IntegratedScan>> newest_scans; ///< likewise, the newest one of each sensor
    Localization localization;                                       ///< likewise, while the session is loaded
};

/// Boxes around the cells of each layer that any scan changed.
struct LayerBounds {
    LaserLayers::Bounds laser; ///< of the laser layers
    grid::CellBox sonar;       ///< of the sonar layer

    friend bool operator==(const LayerBounds&, const LayerBounds&) = default;
};

/// Returns the box of cells that any layer has observed.
/// @param bounds  of all layers
[[nodiscard]] grid::CellBox bounds_of(const LayerBounds& bounds) noexcept;

/// The maps of a session at one revision, shared by all readers. Immutable; hold it by shared_ptr<const Snapshot> as
/// long as needed.
struct Snapshot {
    Revision revision = 0;                         ///< of the newest entry that the maps contain
    MapConfig config;                              ///< settings of the session
    SharedExclusions exclusions = no_exclusions(); ///< of the session's log
    LayerBounds bounds;                            ///< of all layers
    bool is_localize_only = false;                 ///< whether the next scans do not change the maps
    std::size_t chunk_count = 0;                   ///< of laser and sonar layers
    LaserView laser;                               ///< occupancy, HIMM and types
    SonarView sonar;                               ///< log-odds from sonars
    classify::ClassView classes;                   ///< classification
    std::vector<RobotState> robots;                ///< by RobotIndex
    ScanPoses scan_poses;                          ///< of the scans that were sent without poses
    std::uint64_t moving_scans = 0;                ///< scans whose corrected poses these maps do not show
};

/// Returns whether the maps depend on poses that robots did not send: any robot's poses are not Poses::kMap.
[[nodiscard]] inline bool has_estimated_poses(const Snapshot& snapshot) noexcept {
    return std::ranges::any_of(snapshot.robots, [](const auto& robot) { return robot.poses != Poses::kMap; });
}

/// Returns the box of cells that a layer shows.
/// @param snapshot  the maps
/// @param layer     any layer
[[nodiscard]] grid::CellBox bounds_of(const Snapshot& snapshot, Layer layer) noexcept;

/// Returns the box of cells that any layer has observed.
[[nodiscard]] inline grid::CellBox bounds_of(const Snapshot& snapshot) noexcept { return bounds_of(snapshot.bounds); }

/// The cells of one chunk of a layer, bottom row first.
template <class Value>
using ChunkCells = std::array<Value, std::size_t{grid::kChunkSide} * grid::kChunkSide>;

/// Returns whether a laser or sonar has observed the cell.
[[nodiscard]] constexpr bool is_known(LogOdds cell) noexcept { return cell != kUnknownLogOdds; }
/// Returns whether a laser has observed the cell.
[[nodiscard]] constexpr bool is_known(HimmCount cell) noexcept { return cell != kUnseenHimm; }
/// Returns whether the cell is explored or a frontier.
[[nodiscard]] constexpr bool is_known(classify::CellClass cell) noexcept {
    return cell != classify::CellClass::kUnexplored;
}

/// Calls use(view, cells_of) and returns its result.
///
/// `view` is the ChunkView that contains the layer; cells_of(chunk) returns the layer's ChunkCells of one of its
/// chunks.
/// @param snapshot  the maps
/// @param layer     any layer
/// @param use       called once
template <class Use>
decltype(auto) with_layer(const Snapshot& snapshot, Layer layer, Use&& use) {
    switch (layer) {
    case Layer::kOccupancy:
        return use(
            snapshot.laser, [](const LaserChunk& chunk) -> const auto& { return chunk.occupancy; });
    case Layer::kHimm:
        return use(
            snapshot.laser, [](const LaserChunk& chunk) -> const auto& { return chunk.himm; });
    case Layer::kSonar:
        return use(
            snapshot.sonar, [](const SonarChunk& chunk) -> const auto& { return chunk.cells; });
    case Layer::kClassification:
        return use(
            snapshot.classes, [](const classify::ClassChunk& chunk) -> const auto& { return chunk.cells; });
    }
    std::abort(); // each layer has a case
}

/// Returns the SHA-256 digest of a layer's cells and cell size, in lower-case hexadecimal.
///
/// Equal maps have equal digests, whatever order, batches or checkpoints they were made through; different maps have
/// different digests.
///
/// The hash covers the cell size in metres as a float64, then, in increasing order of ChunkKey, each chunk that
/// contains a known cell: ci and cj as int32 and the 4096 cells, bottom row first. All numbers are little-endian. A
/// cell is an int16 in the occupancy and sonar layers and one byte in the himm layer (laser_chunk.hpp) and in
/// the classification (classify/cell_class.hpp).
/// @param snapshot  the maps
/// @param layer     any layer
/// Cost: reads every cell of the layer once.
[[nodiscard]] std::string digest_of(const Snapshot& snapshot, Layer layer);

/// The largest map, in chunks, for which main_bounds_of() searches. Larger maps would take more than a few
/// milliseconds.
inline constexpr std::size_t kMainBoundsChunksMax = 65'536;

/// Returns the part of a map to show first: the box of the largest explored area and of the areas around the robots'
/// newest positions. Chunks that touch, or have one chunk between them, belong to the same area. Cells far away that
/// result from a single scan with a wrong pose do not count.
/// @param snapshot  the maps
/// @return the box in cells; empty if nothing is explored or the map has more than kMainBoundsChunksMax chunks
[[nodiscard]] grid::CellBox main_bounds_of(const Snapshot& snapshot);

} // namespace scanloom::mapping
