#pragma once

#include "core/mapping/map_config.hpp"
#include "lab/integrate_recording.hpp"
#include "lab/matrix.hpp"
#include "lab/recording.hpp"
#include "lab/scoring.hpp"
#include "server/tiles/bytes.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::lab {

/// What the maps of all runs along one trajectory, at one cell size, are compared with.
struct Standard {
    GroundTruthCells truth;
    CellMask seen; ///< see visible_cells()
};

/// Returns the standard for the room, with a margin of two metres around it.
[[nodiscard]] Standard make_standard(const std::vector<Pose2>& path, double cell_size_m);

/// Returns the cells where walkers were, as far as scans of them may mark cells, except for their final positions,
/// where the map may show them.
/// Pre: the recording has a scan.
[[nodiscard]] CellMask walked_cells(const Recording& recording, const mapping::MapConfig& config,
                                    const grid::CellBox& box);

struct RunSpec {
    Scene scene;
    double cell_size = 0.0; ///< metres
    RayModelChoice ray_model;
    NoiseChoice noise;
    Start start;
};

/// Returns for example "static_0.05_inverse_sensor_model_none_south_west".
[[nodiscard]] std::string name_of(const RunSpec& spec);

/// Times for one scan, see integrate_recording(); milliseconds.
struct ScanTimes {
    double mean = 0.0;
    double median = 0.0;
    double percentile_95 = 0.0;
};

struct RunResult {
    RunSpec spec;
    Scores scores;              ///< at the end of the run
    std::size_t touched = 0;    ///< cells that any scan changed
    std::size_t of_walkers = 0; ///< readings, without their noise, that hit a walker
    std::string picture;        ///< file name; empty: none
    ScanTimes times;            ///< the only part that differs between equal experiments
};

/// Fractions of a run at which pictures show it.
inline constexpr std::array kMoments{0.10, 0.25, 0.50, 1.00};

/// Interfaces to clock, files and display.
struct Surroundings {
    Now now;
    std::function<Result<>(const std::string& file, const tiles::Bytes& png)> keep_picture;
    std::function<void(const RunSpec& running, std::size_t runs_done, std::size_t scans_done)> on_scan;
};

/// Performs every run of the matrix. Some runs have a picture, see is_pictured().
/// Pre: matrix.scans >= 10, so that the first moment has a scan.
/// Errors: those of integrate_recording() and of keep_picture.
[[nodiscard]] Result<std::vector<RunResult>> run_experiment(const Matrix& matrix, const Surroundings& surroundings);

/// Whether a run has a picture: among runs from the first start, all without noise, and those with noise at 5 cm cells.
[[nodiscard]] bool is_pictured(const Matrix& matrix, const RunSpec& spec);

} // namespace scanloom::lab
