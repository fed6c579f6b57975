#pragma once

#include "common/scan/map_patch.hpp"
#include "server/classify/hysteresis.hpp"
#include "server/mapping/chunk_grid.hpp"
#include "server/mapping/himm.hpp"
#include "server/mapping/laser_chunk.hpp"
#include "server/mapping/map_config.hpp"
#include "server/mapping/occupancy.hpp"
#include "server/mapping/ray_models.hpp"
#include "server/mapping/sweep/fan_ring.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace scanloom::mapping {

using LaserView = grid::ChunkView<LaserChunk>;

/// The directions of a sensor's beams, as each model wants them. Made once, used by many scans.
struct LaserFan {
    std::shared_ptr<const FanRing> occupancy; ///< for the inverse sensor model
    std::shared_ptr<const FanRing> himm;      ///< the same one where the apertures are alike
    std::vector<Direction> beams;             ///< for the models that trace rays; empty for the inverse sensor model
};

/// `aperture` is the sensor's own, 0 where it states none.
[[nodiscard]] LaserFan make_laser_fan(const MapConfig& config, const BeamAngles& angles, double aperture);

/// One sweep of a laser.
struct LaserScan {
    const LaserFan& fan;
    std::span<const RangeMm> ranges; ///< one for each beam that the fan was made from
    Pose2 T_map_sensor;
    ReadingRules readings;
};

/// The layers that lasers make, updated scan by scan: occupancy, HIMM, and the hysteresis of the classes.
/// Thread  one writer; views may be read by anyone.
/// Source  each layer's: occupancy.hpp, himm.hpp, classify/hysteresis.hpp.
class LaserLayers {
public:
    explicit LaserLayers(const MapConfig& config);

    /// Adds the evidence of one scan, the log's entry `revision`, as far as `work` (as Reach::work) allows; what was
    /// used is taken from it.
    /// @return whether all of the scan is in; until then nothing but the same call may follow.
    [[nodiscard]] bool integrate(const LaserScan& scan, Revision revision, double& work);

    /// Takes over what a map that was made elsewhere says, the log's entry `revision`, as certain as cells can be.
    /// Where its cells are no larger than ours, one of ours is occupied when any of those whose centres it holds is,
    /// else free when any is; where they are larger, it is as the one that holds its centre.
    /// Pre  no scan has been integrated: what is free does not erase what is occupied.
    void import(const MapPatch& patch, Revision revision);

    /// The cells that any scan changed.
    struct Bounds {
        grid::CellBox occupancy;
        grid::CellBox himm;

        friend bool operator==(const Bounds&, const Bounds&) = default;
    };
    [[nodiscard]] const Bounds& bounds() const noexcept { return bounds_; }

    /// Puts back what a checkpoint holds.
    void restore(const Bounds& bounds) { bounds_ = bounds; }
    [[nodiscard]] LaserChunk& restore(grid::ChunkKey key, Revision revision) { return grid_.restore(key, revision); }
    [[nodiscard]] Revision newest_restored() const noexcept { return grid_.newest_restored(); }

    [[nodiscard]] std::size_t chunk_count() const noexcept { return grid_.chunk_count(); }
    [[nodiscard]] std::size_t copied() const noexcept { return grid_.copied(); }

    [[nodiscard]] LaserView snapshot() { return grid_.snapshot(); }

    /// See grid::ChunkTree::branch(). Pre: not within a scan.
    [[nodiscard]] LaserLayers branch() {
        LaserLayers other(config_, grid_.branch());
        other.bounds_ = bounds_;
        return other;
    }

private:
    LaserLayers(const MapConfig& config, ChunkGrid<LaserChunk> grid);

    /// What comes after what within a scan. The inverse sensor model does all in one.
    enum class Stage { kBeams, kMarks, kSweep, kClasses };

    [[nodiscard]] static Stage first_stage(const MapConfig& config);
    [[nodiscard]] bool trace_beams(const LaserScan& scan, double& work);
    [[nodiscard]] bool add_marks(double& work);
    [[nodiscard]] bool sweep(const LaserScan& scan, double& work);
    [[nodiscard]] bool fold_classes(double& work);
    void add_first_marks();
    void weave(grid::ChunkKey key, std::span<const ChunkVerdicts> verdicts);
    [[nodiscard]] grid::BitPlane undecided(const classify::OccPlanes& types, const ChunkVerdicts& verdicts) const;
    void fold_types(LaserChunk& chunk, const grid::BitPlane& touched) const;
    void set(grid::Cell cell, MapCell to);

    const MapConfig config_;
    const OccupancyRule occupancy_;
    const HimmRule himm_;
    const classify::Hysteresis<LogOdds> by_occupancy_;
    const classify::Hysteresis<HimmCount> by_himm_;

    ChunkGrid<LaserChunk> grid_;
    Bounds bounds_;

    // Of the scan that is being integrated.
    Stage stage_;
    std::size_t done_ = 0;  // of the stage: beams, strips, chunks
    grid::CellBox touched_; // by what folds its classes later
    ScanMarks marks_;
    std::vector<grid::ChunkKey> changed_;
};

} // namespace scanloom::mapping
