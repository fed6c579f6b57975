#include "server/foxglove/status_message.hpp"

#include "common/ros/ros_writer.hpp"
#include "server/foxglove/log_time.hpp"
#include "server/foxglove/robot_messages.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>
#include <utility>

namespace scanloom::foxglove {
namespace {

/// The levels of diagnostic_msgs/DiagnosticStatus.
enum class Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2 };

Level level_of(LocalizationState state, bool is_connected) {
    if (state == LocalizationState::kLost) return Level::kError;
    return state == LocalizationState::kUnlocated || !is_connected ? Level::kWarning : Level::kOk;
}

void add_robot(const mapping::RobotState& robot, bool is_connected, RosWriter& message) {
    const auto& how = robot.localization;
    message.add(static_cast<std::uint8_t>(level_of(how.state, is_connected)));
    message.add_text(robot.name);
    message.add_text(fmt::format("{}{}", name_of(how.state), is_connected ? "" : ", not connected"));
    message.add_text(robot.name); // hardware_id
    const std::pair<std::string_view, std::string> values[] = {
        {"scans", fmt::format("{}", robot.scan_count)},
        {"scans without a place", fmt::format("{}", robot.unplaced)},
        {"scans left out as jumps", fmt::format("{}", robot.jumps)},
        {"points that fit the map", fmt::format("{:.0f} %", 100.0 * how.inlier_ratio)},
        {"position, standard deviation", fmt::format("{:.3f} m", how.position_sigma)},
        {"loop closures", fmt::format("{}", how.loops)},
        {"corrections of the map", fmt::format("{}", how.corrections)},
    };
    message.add_count(std::size(values));
    for (const auto& [key, value] : values) {
        message.add_text(key);
        message.add_text(value);
    }
}

} // namespace

std::string status_message(const mapping::Snapshot& maps, const std::vector<bool>& connected, double stamp) {
    RosWriter message(RosEncoding::kCdr);
    message.add_header(nanoseconds_of(stamp), kMapFrame);
    message.add_count(maps.robots.size());
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        add_robot(maps.robots[n], n < connected.size() && connected[n], message);
    }
    return message.take();
}

} // namespace scanloom::foxglove
