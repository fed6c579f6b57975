#pragma once

#include "core/mapping/chunk_grid.hpp"
#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/sonar_model.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::mapping {

/// The log-odds of one chunk's cells.
using SonarChunk = grid::Chunk<LogOdds>;
/// The sonar layer at one moment.
using SonarView = grid::ChunkView<SonarChunk>;

/// The cone of one sonar beam, divided into sectors.
struct SonarCone {
    double angle = 0.0; ///< of its axis, radians in the sensor frame
    BeamFan sectors;    ///< directions within half the aperture of the axis
};

/// The cones of all beams of a sonar ring. Cones may overlap.
struct SonarFan {
    double aperture = 0.0;        ///< full width of a cone, radians
    std::vector<SonarCone> cones; ///< one for each beam
};

/// Prepares the cones of a sonar ring for integration.
/// @param config    aperture for sensors that state none
/// @param angles    axes of the cones, radians in the sensor frame
/// @param aperture  beam width that the sensor states, in radians; 0 if it states none
[[nodiscard]] SonarFan make_sonar_fan(const MapConfig& config, const BeamAngles& angles, double aperture);

/// Returns the probability of occupation that an echo gives for a cell, before it is limited.
///
/// With w = ((R - r) / R + (h - a) / h) / 2, the probability is 0.5 + 0.5 w in region I, the band around the echo, and
/// 0.5 (1 - w) in region II, before the band.
/// @param region  kOccupied for region I, kFree for region II
/// @param r  the cell's distance, metres
/// @param range_max  R, metres
/// @param a  the cell's angle from the cone's axis, radians
/// @param half_aperture  h, radians
/// Source: Murphy, Introduction to AI Robotics (2000), section 11.3.
[[nodiscard]] double sonar_probability(Verdict region, double r, double range_max, double a,
                                       double half_aperture) noexcept;

/// One firing of a ring of sonars.
struct SonarScan {
    const SonarFan& fan;             ///< of the sensor, for as many beams as the scan has
    std::span<const RangeMm> ranges; ///< one for each cone
    Pose2 T_map_sensor;              ///< pose of the sensor at the scan: metres, radians
    ReadingRules readings;           ///< range limits of the sensor
};

/// The occupancy grid derived from sonars, separate from that of lasers.
///
/// Cells are fixed-point log-odds, because the product rule for probabilities is a sum of log-odds. Each cone is a
/// separate measurement.
/// Threads: one writer; any number of threads may read views.
/// Source: Murphy (2000), section 11.4; Moravec, Elfes, High Resolution Maps from Wide Angle Sonar (1985).
class SonarLayer {
public:
    /// Creates a layer in which no cell was observed.
    explicit SonarLayer(const MapConfig& config);

    /// Integrates one scan, or a part of it as large as `work` allows.
    /// @param scan      the same object, with the same contents, until the result is true
    /// @param revision  revision of the scan's log entry
    /// @param work      budget in the unit of Reach::work; reduced by the work that was done
    /// @return whether the scan is completely integrated; if false, repeat the call with the same scan before any other
    ///         change
    [[nodiscard]] bool integrate(const SonarScan& scan, Revision revision, double& work);

    /// Makes the layer equal to another one, as a change by the newest entry: writes the chunks whose cells differ.
    /// @param other     with the same settings
    /// @param revision  of the newest entry
    /// Precondition: no scan is partially integrated.
    void replace_with(SonarLayer other, Revision revision);

    /// Returns the box around the cells that any scan changed.
    [[nodiscard]] const grid::CellBox& bounds() const noexcept { return bounds_; }

    /// Restores the state of a checkpoint.
    void restore(const grid::CellBox& bounds) { bounds_ = bounds; }
    /// Restores a chunk of a checkpoint and returns it; the caller fills in its cells.
    [[nodiscard]] SonarChunk& restore(grid::ChunkKey key, Revision revision) { return grid_.restore(key, revision); }
    /// Returns the newest revision of all restored chunks; 0 if none was restored.
    [[nodiscard]] Revision newest_restored() const noexcept { return grid_.newest_restored(); }

    /// Returns the number of chunks.
    [[nodiscard]] std::size_t chunk_count() const noexcept { return grid_.chunk_count(); }
    /// See ChunkTree::copied().
    [[nodiscard]] std::size_t copied() const noexcept { return grid_.copied(); }

    /// Returns the current layer. Later writes do not change the snapshot.
    [[nodiscard]] SonarView snapshot() { return grid_.snapshot(); }

    /// Returns a copy that has its own writer; see grid::ChunkTree::branch().
    /// Precondition: no scan is partially integrated.
    [[nodiscard]] SonarLayer branch() {
        SonarLayer other(config_, grid_.branch());
        other.bounds_ = bounds_;
        return other;
    }

private:
    SonarLayer(const MapConfig& config, ChunkGrid<SonarChunk> grid);

    void add(const SonarScan& scan, std::size_t cone);
    [[nodiscard]] int step_of(Verdict region, double r, double range_max, double a,
                              double half_aperture) const noexcept;

    const MapConfig config_;
    const LogOdds l_min_;
    const LogOdds l_max_;
    ChunkGrid<SonarChunk> grid_;
    grid::CellBox bounds_;
    std::size_t done_ = 0; // completed cones of the scan that is being integrated
};

} // namespace scanloom::mapping
