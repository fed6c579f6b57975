#pragma once

#include "server/mapping/chunk_grid.hpp"
#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/log_odds.hpp"
#include "server/mapping/map_config.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::mapping {

using SonarChunk = grid::Chunk<LogOdds>;
using SonarView = grid::ChunkView<SonarChunk>;

/// The cone of one beam, divided into sectors.
struct SonarCone {
    double angle = 0.0; ///< of its axis, radians in the sensor frame
    BeamFan sectors;
};

/// Every beam of a ring; cones may overlap. `aperture` is the full width of each, radians.
struct SonarFan {
    double aperture = 0.0;
    std::vector<SonarCone> cones;
};

/// `aperture` is the sensor's own, 0 where it states none.
[[nodiscard]] SonarFan make_sonar_fan(const MapConfig& config, const BeamAngles& angles, double aperture);

/// What an echo says of a cell, before it is limited: the probability of occupation, with
///   w = ((R - r) / R + (h - a) / h) / 2
/// 0.5 + 0.5 w in region I, the band around the echo, and 0.5 (1 - w) in region II, before it.
/// Units   metres: r, the cell's distance, and R, range_max; radians: a, its angle off the axis, and h, half the
///         aperture.
/// Source  Murphy, Introduction to AI Robotics (2000), section 11.3.
[[nodiscard]] double sonar_probability(Verdict region, double r, double range_max, double a,
                                       double half_aperture) noexcept;

/// One firing of a ring of sonars.
struct SonarScan {
    const SonarFan& fan;
    std::span<const RangeMm> ranges; ///< one for each cone
    Pose2 T_map_sensor;
    ReadingRules readings;
};

/// The occupancy grid that sonars make, apart from that of lasers: fixed-point log-odds, as the product rule for
/// probabilities is a sum of them. Each cone is a measurement of its own.
/// Thread  one writer; views may be read by anyone.
/// Source  Murphy (2000), section 11.4; Moravec, Elfes, High Resolution Maps from Wide Angle Sonar (1985).
class SonarLayer {
public:
    explicit SonarLayer(const MapConfig& config);

    /// As LaserLayers::integrate().
    [[nodiscard]] bool integrate(const SonarScan& scan, Revision revision, double& work);

    /// The cells that any scan changed.
    [[nodiscard]] const grid::CellBox& bounds() const noexcept { return bounds_; }

    /// Puts back what a checkpoint holds.
    void restore(const grid::CellBox& bounds) { bounds_ = bounds; }
    [[nodiscard]] SonarChunk& restore(grid::ChunkKey key, Revision revision) { return grid_.restore(key, revision); }
    [[nodiscard]] Revision newest_restored() const noexcept { return grid_.newest_restored(); }

    [[nodiscard]] std::size_t chunk_count() const noexcept { return grid_.chunk_count(); }
    [[nodiscard]] std::size_t copied() const noexcept { return grid_.copied(); }

    [[nodiscard]] SonarView snapshot() { return grid_.snapshot(); }

    /// As LaserLayers::branch().
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
    std::size_t done_ = 0; // cones of the scan that is being integrated
};

} // namespace scanloom::mapping
