#include "robot_client/lidars/lidar_driver.hpp"

#include "robot_client/sources/messages.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

std::string lidar_remarks(const LidarCounts& counts, const LidarLosses& losses) {
    std::string text = fmt::format("{}, {}", counted(counts.damaged, "damaged packet"), counted(counts.turns, "turn"));
    const std::string gaps = counted(counts.gaps, "gap");
    if (counts.parts > 0) text += fmt::format(", {} of them cut by {}", counts.parts, gaps);
    if (counts.gaps > 0 && counts.parts == 0) text += fmt::format(", others dropped because of {}", gaps);
    const auto add = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
        if (count > 0) text += fmt::format(", {} {}", counted(count, noun), what);
    };
    add(counts.too_long, "turn", "too slow");
    add(losses.without_pose, "scan", "skipped without a pose");
    add(losses.too_many_waiting, "scan", "dropped by the buffer");
    return text;
}

} // namespace scanloom::robot
