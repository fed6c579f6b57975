#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/session_options.hpp"
#include "sim/range_sensors.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// What the reference experiments vary. Every name is short, because tables and file names contain it.
namespace scanloom::lab {

struct Scene {
    std::string_view name;
    std::string_view world; ///< name in the simulator
};

struct RayModelChoice {
    std::string_view name;
    void (*choose)(SessionOptions& options);
};

struct NoiseChoice {
    std::string_view name;
    std::optional<sim::Noise> (*at)(double cell_size_m);
    bool drops_no_return; ///< omits beams without return, as the reference implementation of this noise does
};

struct Start {
    std::string_view name;
    Pose2 pose;
};

/// Every combination is a run.
struct Matrix {
    std::vector<Scene> scenes;
    std::vector<double> cell_sizes; ///< metres
    std::vector<RayModelChoice> ray_models;
    std::vector<NoiseChoice> noises;
    std::vector<Start> starts;
    std::size_t scans = 0;  ///< per run
    std::uint64_t seed = 1; ///< of the noise

    [[nodiscard]] std::size_t run_count() const noexcept {
        return scenes.size() * cell_sizes.size() * ray_models.size() * noises.size() * starts.size();
    }
};

/// 150 s at ten scans per second: once around the room.
inline constexpr std::size_t kScansDefault = 1500;

[[nodiscard]] Matrix full_matrix();

/// The coarse cells, without noise and with Gaussian noise, from one start: takes seconds instead of minutes.
[[nodiscard]] Matrix quick_matrix();

} // namespace scanloom::lab
