#include "robot_client/sources/lidar_models.hpp"

#include "robot_client/sources/ld06_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace scanloom::robot {
namespace {

// A confidence of 100: see LidarScanOptions.
constexpr std::array kModels{
    LidarModel{"ld06", "an LD06", "LD06", LidarFamily::kLd06, {230'400, {}}, 0.02, 12.0, 100, 450},
    LidarModel{"ld19", "an LD19", "LD19", LidarFamily::kLd06, {230'400, {}}, 0.02, 12.0, 100, 450},
    LidarModel{"stl27l", "an STL-27L", "STL-27L", LidarFamily::kLd06, {921'600, {}}, 0.03, 25.0, 100, 2160},
};

} // namespace

std::span<const LidarModel> lidar_models() noexcept { return kModels; }

const LidarModel* find_lidar_model(std::string_view name) noexcept {
    const auto* found = std::ranges::find(kModels, name, &LidarModel::name);
    return found != kModels.end() ? found : nullptr;
}

Result<LidarScanOptions> scan_options(const LidarModel& model, const LidarSettings& settings) {
    LidarScanOptions scan;
    scan.range_min = settings.range_min.value_or(model.range_min);
    scan.range_max = settings.range_max.value_or(model.range_max);
    scan.no_return = settings.no_return.value_or(scan.no_return);
    scan.confidence_min = static_cast<std::uint8_t>(settings.confidence_min.value_or(model.confidence_min));
    scan.median_window = settings.median_window;
    scan.mount = settings.mount;
    scan.poses = settings.poses;
    if (scan.range_min < scan.range_max) return scan;
    return Error{Errc::kInvalidField,
                 fmt::format("--min-range is {} m, but --max-range is only {} m; no reading would be valid",
                             scan.range_min, scan.range_max)};
}

std::unique_ptr<LidarDriver> make_lidar_driver(const LidarModel& model, const LidarScanOptions& options) {
    return std::make_unique<Ld06Driver>(std::string(model.title), lidar_sensor(model.label, model.beams, options),
                                        options);
}

} // namespace scanloom::robot
