#include "lab/ld06_recording.hpp"

#include "robot_client/source/ld06_capture.hpp"

#include <fmt/format.h>

namespace scanloom::lab {

Result<RecordedCapture> read_ld06_recording(const std::filesystem::path& path) {
    const robot::Ld06ScanOptions options;
    auto source = robot::Ld06Capture::open(path, options, Pose2{});
    if (!source) return source.error();
    RecordedCapture recorded{{*robot::ld06_sensor(options), {}}, path.filename().string(), source->remarks()};
    for (;;) {
        auto next = source->next();
        if (!next) return next.error();
        if (!*next) break;
        recorded.capture.scans.push_back(std::move((*next)->scan));
        recorded.capture.scans.back().seq = recorded.capture.scans.size();
    }
    if (recorded.capture.scans.size() > 1) return recorded;
    return Error{Errc::kInvalidField,
                 fmt::format("{}: one turn only, and its halves are to be compared; record for longer", path.string())};
}

} // namespace scanloom::lab
