#include "server/foxglove/ros_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::foxglove {

std::uint64_t log_time_of(double stamp) noexcept {
    constexpr double kLatest = std::numeric_limits<std::int32_t>::max(); // seconds: ROS 2 has 32 bits
    const double seconds = std::clamp(stamp, 0.0, kLatest);
    const double whole = std::floor(seconds);
    const auto fraction = std::llround((seconds - whole) * static_cast<double>(kNanoseconds));
    return static_cast<std::uint64_t>(whole) * kNanoseconds + static_cast<std::uint64_t>(fraction);
}

void add_time(double stamp, CdrWriter& message) {
    const std::uint64_t time = log_time_of(stamp);
    message.add(static_cast<std::int32_t>(time / kNanoseconds));
    message.add(static_cast<std::uint32_t>(time % kNanoseconds));
}

void add_header(double stamp, std::string_view frame, CdrWriter& message) {
    add_time(stamp, message);
    message.add_text(frame);
}

void add_pose(const Pose2& pose, CdrWriter& message) {
    for (const double metres : {pose.x, pose.y, 0.0}) message.add(metres);
    for (const double part : {0.0, 0.0, std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0)}) message.add(part);
}

} // namespace scanloom::foxglove
