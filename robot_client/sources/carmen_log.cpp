#include "robot_client/sources/carmen_log.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

Result<CarmenLog> CarmenLog::open(const std::filesystem::path& path, const CarmenOptions& options,
                                  const std::function<void(const SkippedLine&)>& report, const OnRead& on_read) {
    auto index = index_carmen_log(path, options, report, on_read);
    if (!index) return index.error();
    auto records = CarmenRecords::open(path, options.limits);
    if (!records) return records.error();
    return CarmenLog(path, options, std::move(*index), std::move(*records));
}

CarmenLog::CarmenLog(const std::filesystem::path& path, const CarmenOptions& options, CarmenIndex index,
                     CarmenRecords records)
    : path_(path.string()), index_(std::move(index)), records_(std::move(records)),
      observer_(options, index_.laser_offset_forward) {}

Result<std::optional<Observation>> CarmenLog::next() {
    if (place_ == index_.scan_count) return std::optional<Observation>{};
    auto line = next_in_place();
    if (!line) return line.error();
    if (line->scan.kind == CarmenKind::kRawLaser) {
        const auto pose = index_.path.at(line->stamp);
        if (!pose) return changed();
        line->scan.robot = *pose;
    }
    auto observation = observer_.observe(line->scan, line->stamp);
    if (!observation) return changed();
    ++place_;
    return std::optional(std::move(*observation));
}

Result<StampedScan> CarmenLog::next_in_place() {
    if (auto early = early_.extract(place_)) return std::move(early.mapped());
    for (;;) {
        auto record = records_.next();
        if (!record) return record.error();
        if (!*record) return changed();
        auto* line = std::get_if<StampedScan>(&(*record)->content);
        if (!line) continue;
        if (laser_lines_ == index_.places.size()) return changed();
        const std::uint32_t place = index_.places[laser_lines_++];
        if (place == CarmenIndex::kUnused) continue;
        if (place == place_) return std::move(*line);
        early_.emplace(place, std::move(*line));
    }
}

Error CarmenLog::changed() const {
    return {Errc::kConflict, fmt::format("{}: the file was changed during the transfer, so the stored scans may be "
                                         "wrong: send the whole file to a new --session",
                                         path_)};
}

} // namespace scanloom::robot
