#pragma once

#include "lab/matrix.hpp"
#include "lab/scoring.hpp"
#include "lab/weaving.hpp"

#include "server/tiles/bytes.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::lab {

struct RunSpec {
    Scene scene;
    double cell_size = 0.0; ///< metres
    RayModelChoice ray_model;
    NoiseChoice noise;
    Start start;
};

/// "static_0.05_inverse_sensor_model_none_south_west"
[[nodiscard]] std::string name_of(const RunSpec& spec);

/// Of one scan, see weave(); milliseconds.
struct ScanTimes {
    double mean = 0.0;
    double median = 0.0;
    double percentile_95 = 0.0;
};

struct RunResult {
    RunSpec spec;
    Scores scores;              ///< at the end of the run
    std::size_t touched = 0;    ///< cells that any scan changed
    std::size_t of_walkers = 0; ///< readings, without their noise, that met a walker
    std::string picture;        ///< name of its file; empty: none
    ScanTimes times;            ///< the only part that differs from one time to the next
};

/// Shares of a run after which pictures show it.
inline constexpr std::array kMoments{0.10, 0.25, 0.50, 1.00};

/// How the world outside takes part.
struct Surroundings {
    Now now;
    std::function<Result<>(const std::string& file, const tiles::Bytes& png)> keep_picture;
    std::function<void(const RunSpec& running, std::size_t runs_done, std::size_t scans_done)> on_scan;
};

/// Makes every run of the matrix. A selection of runs has a picture, see is_pictured().
/// Pre     matrix.scans >= 10, so that the first moment has a scan.
/// Errors  those of weave() and of keep_picture.
[[nodiscard]] Result<std::vector<RunResult>> run_experiment(const Matrix& matrix, const Surroundings& surroundings);

/// From the first start: every run without noise, and at cells of 5 cm those with noise.
[[nodiscard]] bool is_pictured(const Matrix& matrix, const RunSpec& spec);

} // namespace scanloom::lab
