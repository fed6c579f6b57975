#include "lab/ld06_recording.hpp"

#include "lab/lidar_capture.hpp"
#include "robot_client/source/ld06_capture.hpp"
#include "server/landmarks/alignment.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>

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
    const auto& scans = recorded.capture.scans;
    if (scans.size() < 2) {
        return Error{
            Errc::kInvalidField,
            fmt::format("{}: only one turn; the comparison of its halves needs two: record longer", path.string())};
    }
    const auto first = std::span(scans).first(scans.size() / 2);
    const auto last = std::span(scans).subspan(first.size());
    for (const auto& [which, half] : {std::pair{"first", first}, std::pair{"last", last}}) {
        const std::size_t points = points_of(half, recorded.capture.sensor).size();
        if (points >= landmarks::kViewPointsMin) continue;
        return Error{
            Errc::kInvalidField,
            fmt::format(
                "{}: in the {} {} of {} turns only {} points were observed; record where the lidar can see walls",
                path.string(), which, half.size(), scans.size(), points)};
    }
    return recorded;
}

} // namespace scanloom::lab
