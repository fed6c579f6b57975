#include "robot_client/source/carmen_record.hpp"

namespace scanloom::robot {

Result<CarmenRecords> CarmenRecords::open(const std::filesystem::path& path, LineLimits limits, OnRead on_read) {
    auto lines = LineReader::open(path, limits, std::move(on_read));
    if (!lines) return lines.error();
    return CarmenRecords(std::move(*lines));
}

Result<std::optional<CarmenRecord>> CarmenRecords::next() {
    for (;;) {
        const auto line = lines_.next();
        if (!line) return line.error();
        if (!*line) return std::optional<CarmenRecord>{};
        CarmenRecord record{lines_.line_number(), **line, CarmenLaserOffset{}};
        auto parsed = parse_carmen_line(record.text);
        if (!parsed) {
            record.content = parsed.error();
        } else if (auto* scan = std::get_if<CarmenScan>(&*parsed)) {
            last_stamp_ = scan->stamp.value_or(last_stamp_);
            record.content = StampedScan{std::move(*scan), last_stamp_};
        } else if (const auto* odometry = std::get_if<CarmenOdometry>(&*parsed)) {
            record.content = *odometry;
        } else if (const auto* offset = std::get_if<CarmenLaserOffset>(&*parsed)) {
            record.content = *offset;
        } else if (const auto* unread = std::get_if<CarmenUnreadLaser>(&*parsed)) {
            record.content = *unread;
        } else {
            continue; // a comment, or a line without laser data
        }
        return std::optional(std::move(record));
    }
}

} // namespace scanloom::robot
