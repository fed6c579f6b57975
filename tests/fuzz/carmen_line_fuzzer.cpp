#include "common/scan/limits.hpp"
#include "robot_client/sources/carmen_line.hpp"
#include "tests/fuzz/check.hpp"

/// Input: one line of a CARMEN log.
SCANLOOM_FUZZER(carmen_line)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const auto line = robot::parse_carmen_line({reinterpret_cast<const char*>(data), size});
    if (!line) {
        fuzz::check(!line.error().message.empty(), "every error has a message");
        return 0;
    }
    if (const auto* scan = std::get_if<robot::CarmenScan>(&*line)) {
        fuzz::check(!scan->ranges.empty() && scan->ranges.size() <= kBeamsMax, "a scan has 1 to 4096 beams");
        fuzz::check(scan->angles.count == scan->ranges.size(), "each beam has its angle");
        fuzz::check(is_finite(scan->laser) && is_finite(scan->robot), "poses are finite");
    }
    return 0;
}
