#include "robot_client/lidars/lidar_models.hpp"

#include "robot_client/lidars/hokuyo_driver.hpp"
#include "robot_client/lidars/ld06_driver.hpp"
#include "robot_client/lidars/rplidar_driver.hpp"
#include "robot_client/lidars/ydlidar_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace scanloom::robot {
namespace {

// A confidence of 100: see LidarScanOptions; it was not measured for the STL-27L. DTR: its level "off" lets the motor
// of an RPLIDAR A1 turn, "on" that of a YDLIDAR. The A2's and newer motors do not depend on it.
using enum LidarFamily;
constexpr std::array kModels{
    LidarModel{"ld06", "an LD06", "LD06", kLd06, {230'400, {}}, 0.02, 12.0, 100, 450},
    LidarModel{"ld19", "an LD19", "LD19", kLd06, {230'400, {}}, 0.02, 12.0, 100, 450},
    LidarModel{"stl27l", "an STL-27L", "STL-27L", kLd06, {921'600, {}}, 0.03, 25.0, 0, 2160},
    LidarModel{"rplidar-a1", "an RPLIDAR A1", "RPLIDAR A1", kRplidar, {115'200, false}, 0.15, 12.0, 0, 720},
    LidarModel{"rplidar-a2", "an RPLIDAR A2", "RPLIDAR A2", kRplidar, {115'200, false}, 0.15, 12.0, 0, 400},
    LidarModel{"rplidar-c1", "an RPLIDAR C1", "RPLIDAR C1", kRplidar, {460'800, {}}, 0.05, 12.0, 0, 500},
    LidarModel{"ydlidar-x2", "a YDLIDAR X2", "YDLIDAR X2", kYdlidarX2, {115'200, true}, 0.1, 8.0, 0, 430},
    LidarModel{"ydlidar-x4", "a YDLIDAR X4", "YDLIDAR X4", kYdlidarX4, {128'000, true}, 0.12, 10.0, 0, 720},
    LidarModel{"hokuyo", "a Hokuyo", "Hokuyo", kHokuyo, {115'200, {}}, 0.0, 0.0, 0, 0},
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
    if (scan.range_min < scan.range_max || scan.range_max <= 0.0) return scan; // the sensor is asked
    return Error{Errc::kInvalidField,
                 fmt::format("--min-range is {} m, but --max-range is only {} m; no reading would be valid",
                             scan.range_min, scan.range_max)};
}

std::unique_ptr<LidarDriver> make_lidar_driver(const LidarModel& model, const LidarScanOptions& options) {
    const std::string title(model.title);
    if (model.family == kHokuyo) return std::make_unique<HokuyoDriver>(options);
    auto sensor = lidar_sensor(model.label, model.beams, options);
    switch (model.family) {
    case kLd06: break;
    case kRplidar: return std::make_unique<RplidarDriver>(title, std::move(sensor), options);
    case kYdlidarX2: return std::make_unique<YdlidarDriver>(title, false, std::move(sensor), options);
    case kYdlidarX4: return std::make_unique<YdlidarDriver>(title, true, std::move(sensor), options);
    case kHokuyo: break;
    }
    return std::make_unique<Ld06Driver>(title, std::move(sensor), options);
}

} // namespace scanloom::robot
