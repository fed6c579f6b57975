#pragma once

#include "common/scan/log_entry.hpp"
#include "core/classify/cell_class.hpp"
#include "core/mapping/chunk_grid.hpp"
#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/occupancy.hpp"
#include "core/mapping/ray_models.hpp"
#include "core/mapping/sweep/sweep.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace scanloom::mapping {

/// The layers from lasers at one moment.
using LaserView = grid::ChunkView<LaserChunk>;

/// The directions of a sensor's beams, in the form that each ray model needs. Made once and used for many scans.
struct LaserFan {
    std::shared_ptr<const FanRing> occupancy; ///< for the inverse sensor model
    std::shared_ptr<const FanRing> himm; ///< for the HIMM layer; shared with `occupancy` if the apertures are equal
    std::vector<Direction> beams;        ///< for the models that trace rays; empty for the inverse sensor model
};

/// Prepares the beam directions of a sensor for integration.
/// @param config    ray model and apertures
/// @param angles    radians in the sensor frame, one per beam
/// @param aperture  beam width that the sensor states, in radians; 0 if it states none
[[nodiscard]] LaserFan make_laser_fan(const MapConfig& config, const BeamAngles& angles, double aperture);

/// One laser scan.
struct LaserScan {
    const LaserFan& fan;             ///< of the sensor, for as many beams as the scan has
    std::span<const RangeMm> ranges; ///< one for each beam of the fan
    Pose2 T_map_sensor;              ///< pose of the sensor at the scan: metres, radians
    ReadingRules readings;           ///< range limits of the sensor
};

/// The layers derived from laser scans: occupancy, HIMM, and the hysteresis of the classes. Updated scan by scan.
/// Threads: one writer; any number of threads may read views.
/// Source: see occupancy.hpp, laser_chunk.hpp and core/classify/cell_class.hpp.
class LaserLayers {
public:
    /// Creates layers in which no cell was observed.
    explicit LaserLayers(const MapConfig& config);

    /// Integrates one scan, or a part of it as large as `work` allows.
    /// @param scan      the same object, with the same contents, until the result is true
    /// @param revision  revision of the scan's log entry
    /// @param work      budget in the unit of Reach::work; reduced by the work that was done
    /// @return whether the scan is completely integrated; if false, repeat the call with the same scan before any other
    ///         change
    [[nodiscard]] bool integrate(const LaserScan& scan, Revision revision, double& work);

    /// Imports a part of an existing map, setting its cells to the clamps.
    ///
    /// If the patch's cells are no larger than the cells of this map, a cell of this map is occupied if any patch cell
    /// whose centre it contains is occupied; otherwise, it is free if any of them is free. If the patch's cells are
    /// larger, a cell takes the value of the patch cell that contains its centre.
    /// Precondition: no scan has been integrated. A free patch cell does not overwrite an occupied one.
    /// @param patch     metres, map frame
    /// @param revision  revision of the patch's log entry
    void import(const MapPatch& patch, Revision revision);

    /// Makes the layers equal to others, as a change by the newest entry: writes the chunks whose cells differ.
    /// @param other     with the same settings
    /// @param revision  of the newest entry
    /// Precondition: no scan is partially integrated.
    void replace_with(LaserLayers other, Revision revision);

    /// Boxes around the cells that scans or imported maps changed.
    struct Bounds {
        grid::CellBox occupancy; ///< of the occupancy layer and the classes
        grid::CellBox himm;      ///< of the HIMM layer

        friend bool operator==(const Bounds&, const Bounds&) = default;
    };
    /// Returns the boxes around the cells that scans or imported maps changed.
    [[nodiscard]] const Bounds& bounds() const noexcept { return bounds_; }

    /// Restores the state of a checkpoint.
    void restore(const Bounds& bounds) { bounds_ = bounds; }
    /// Restores a chunk of a checkpoint and returns it; the caller fills in its cells.
    [[nodiscard]] LaserChunk& restore(grid::ChunkKey key, Revision revision) { return grid_.restore(key, revision); }
    /// Returns the newest revision of all restored chunks; 0 if none was restored.
    [[nodiscard]] Revision newest_restored() const noexcept { return grid_.newest_restored(); }

    /// Returns the number of chunks.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return grid_.chunk_count(); }
    /// See ChunkTree::copied().
    [[nodiscard]] std::size_t copied() const noexcept { return grid_.copied(); }

    /// Returns the current layers. Later writes do not change the snapshot.
    [[nodiscard]] LaserView snapshot() { return grid_.snapshot(); }

    /// Returns a copy that has its own writer; see grid::ChunkTree::branch().
    /// Precondition: no scan is partially integrated.
    [[nodiscard]] LaserLayers branch() {
        LaserLayers other(config_, grid_.branch());
        other.bounds_ = bounds_;
        return other;
    }

private:
    LaserLayers(const MapConfig& config, ChunkGrid<LaserChunk> grid);

    /// The stages of integrating a scan, in order. With the inverse sensor model, kSweep does the work of all stages.
    enum class Stage { kBeams, kMarks, kSweep, kClasses };

    [[nodiscard]] static Stage first_stage(const MapConfig& config);
    [[nodiscard]] bool trace_beams(const LaserScan& scan, double& work);
    [[nodiscard]] bool add_marks(double& work);
    [[nodiscard]] bool sweep(const LaserScan& scan, double& work);
    [[nodiscard]] bool update_classes(double& work);
    void add_first_marks();
    void integrate_chunk(grid::ChunkKey key, std::span<const ChunkVerdicts> verdicts);
    [[nodiscard]] grid::BitPlane undecided(const classify::OccPlanes& types, const ChunkVerdicts& verdicts) const;
    void update_types(LaserChunk& chunk, const grid::BitPlane& touched) const;
    void set(grid::Cell cell, MapCell to);

    const MapConfig config_;
    const OccupancyRule occupancy_;
    const HimmRule himm_;
    const classify::Hysteresis<LogOdds> by_occupancy_;
    const classify::Hysteresis<HimmCount> by_himm_;

    ChunkGrid<LaserChunk> grid_;
    Bounds bounds_;

    // State of the scan that is being integrated.
    Stage stage_;
    std::size_t done_ = 0;  // beams, strips or chunks that the stage has completed
    grid::CellBox touched_; // cells whose classes kClasses updates
    ScanMarks marks_;
    std::vector<grid::ChunkKey> changed_;
};

} // namespace scanloom::mapping
