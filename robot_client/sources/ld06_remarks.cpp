#include "robot_client/sources/ld06_remarks.hpp"

#include "robot_client/sources/counted.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

std::string ld06_remarks(const Ld06Counts& counts, const Ld06Turns& turns, const Ld06Losses& losses) {
    std::string text = fmt::format("{}, {}", counted(counts.crc_failures + counts.implausible, "damaged packet"),
                                   counted(turns.count(), "turn"));
    if (turns.gaps() > 0) {
        text += fmt::format(", {} of them cut by {}", turns.parts(), counted(turns.gaps(), "gap"));
    }
    const auto add = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
        if (count > 0) text += fmt::format(", {} {}", counted(count, noun), what);
    };
    add(turns.too_long(), "turn", "too slow");
    add(losses.without_pose, "scan", "skipped without a pose");
    add(losses.too_many_waiting, "scan", "dropped by the buffer");
    return text;
}

} // namespace scanloom::robot
