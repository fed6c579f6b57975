#include "robot_client/app/ld06_source.hpp"

#include "robot_client/source/ld06_capture.hpp"
#include "robot_client/source/pose_lines.hpp"

#include <fmt/format.h>

#include <iostream>

namespace scanloom::robot {
namespace {

constexpr std::size_t kSkippedLinesShown = 5;
constexpr std::string_view kStandardInput = "-";

Result<Ld06ScanOptions> scan_options(const RobotOptions& options, const Ld06Options& ld06) {
    Ld06ScanOptions scan;
    scan.range_min = ld06.range_min.value_or(scan.range_min);
    scan.range_max = options.range_max.value_or(scan.range_max);
    scan.no_return = options.no_return.value_or(scan.no_return);
    if (ld06.confidence_min) scan.confidence_min = static_cast<std::uint8_t>(*ld06.confidence_min);
    scan.median_window = ld06.median_window;
    scan.mount = ld06.mount;
    if (scan.range_min < scan.range_max) return scan;
    return Error{Errc::kInvalidField,
                 fmt::format("--min-range is {} m, but --max-range only {} m; nothing lies between", scan.range_min,
                             scan.range_max)};
}

Result<PoseLines> read_poses(const Ld06Options& ld06, Console& console) {
    const std::string name = ld06.poses == kStandardInput ? "stdin" : ld06.poses;
    std::size_t skipped = 0;
    const auto tell = [&](const SkippedLine& line) {
        if (++skipped <= kSkippedLinesShown) {
            console.note(fmt::format("{}:{}: skipped: {}", name, line.line_number, line.reason));
        }
    };
    auto lines = ld06.poses == kStandardInput ? read_pose_lines(std::cin, name, tell) : read_pose_lines(name, tell);
    if (skipped > kSkippedLinesShown) {
        console.note(fmt::format("{}: {} more lines skipped", name, skipped - kSkippedLinesShown));
    }
    return lines;
}

Result<PreparedSource> prepare_capture(const Ld06Options& ld06, const Ld06ScanOptions& scan, Console& console) {
    Ld06Poses poses = ld06.pose.value_or(Pose2{});
    std::size_t skipped = 0;
    if (!ld06.pose) {
        auto lines = read_poses(ld06, console);
        if (!lines) return lines.error();
        skipped = lines->skipped;
        poses = std::move(lines->poses);
    }
    auto capture = Ld06Capture::open(ld06.input, scan, std::move(poses));
    if (!capture) return capture.error();
    console.note(fmt::format("{}: {}", ld06.input, capture->remarks()));
    PreparedSource prepared{nullptr, skipped, ld06.speed, capture->fingerprint(), "time", {}};
    prepared.source = std::make_unique<Ld06Capture>(std::move(*capture));
    return prepared;
}

} // namespace

Result<PreparedSource> prepare_ld06(const RobotOptions& options, const Ld06Options& ld06, Console& console) {
    const auto scan = scan_options(options, ld06);
    if (!scan) return scan.error();
    return prepare_capture(ld06, *scan, console);
}

} // namespace scanloom::robot
