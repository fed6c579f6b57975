#include "robot_client/sources/carmen_index.hpp"

#include "common/hash/sha256.hpp"
#include "robot_client/sources/carmen_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace scanloom::robot {

ScanOrder order_of(std::span<const double> stamps) {
    ScanOrder result;
    result.order.resize(stamps.size());
    std::iota(result.order.begin(), result.order.end(), 0U);

    std::vector<double> newest(stamps.begin(), stamps.end()); // newest stamp of each scan's part, up to that scan
    for (std::size_t i = 1; i < stamps.size(); ++i) {
        if (stamps[i] < stamps[i - 1]) ++result.steps_back;
        const double back = newest[i - 1] - stamps[i];
        result.back_max = std::max(result.back_max, back);
        if (back > kStampJitterMax) result.is_of_file = false;
        if (back <= kStampJitterMax) newest[i] = std::max(newest[i - 1], stamps[i]);
    }
    std::ranges::stable_sort(result.order, {}, [&](std::uint32_t i) { return newest[i]; });
    result.is_of_stamps = std::ranges::is_sorted(result.order, {}, [&](std::uint32_t i) { return stamps[i]; });
    return result;
}

namespace {

struct LaserLine {
    double stamp = 0.0;
    std::size_t line_number = 0;
    bool is_raw = false;
    bool is_used = false;
};

class Indexer {
public:
    Indexer(const CarmenOptions& options, const std::function<void(const SkippedLine&)>& report)
        : options_(options), report_(report) {
        hash_.update("carmen 1\n"); // increase it when the same lines give different scans
    }

    [[nodiscard]] Result<> read(CarmenRecords& records);
    [[nodiscard]] CarmenIndex build();

private:
    void take(const CarmenRecord& record, const StampedScan& line);
    void take(const CarmenRecord& record, const CarmenOdometry& odometry);
    void take(const CarmenRecord& record, const CarmenLaserOffset& offset);
    void take(const CarmenRecord& record, const CarmenUnreadLaser& line);
    void take(const CarmenRecord& record, const Error& error) { skip(record.line_number, error.message); }
    void hash(std::string_view line);
    void skip(std::size_t line_number, std::string reason);
    void report_unread_kinds();
    void keep_one_view_of_each_scan();
    void drop_lines_without_pose(const PosePath& path);
    void order_scans(CarmenIndex& index);
    [[nodiscard]] std::string fingerprint();

    const CarmenOptions& options_;
    const std::function<void(const SkippedLine&)>& report_;
    Sha256 hash_;
    std::vector<LaserLine> lines_;
    std::vector<StampedPose> odometry_;
    double laser_offset_forward_ = 0.0;
    bool has_flaser_ = false;
    bool has_robot_laser_ = false;
    bool has_raw_ = false;
    std::size_t skipped_ = 0;

    struct UnreadKind {
        std::size_t first_line = 0;
        std::size_t count = 0;
    };
    std::map<std::string_view, UnreadKind> unread_;
};

Result<> Indexer::read(CarmenRecords& records) {
    for (;;) {
        const auto record = records.next();
        if (!record) return record.error();
        if (!*record) return {};
        std::visit([&](const auto& content) { take(**record, content); }, (*record)->content);
        if (lines_.size() == CarmenIndex::kUnused) {
            return Error{Errc::kTooLarge, fmt::format("more than {} laser lines; split the log", lines_.size() - 1)};
        }
    }
}

void Indexer::take(const CarmenRecord& record, const StampedScan& line) {
    hash(record.text);
    const CarmenKind kind = line.scan.kind;
    has_flaser_ |= kind == CarmenKind::kFlaser;
    has_robot_laser_ |= kind == CarmenKind::kRobotLaser;
    has_raw_ |= kind == CarmenKind::kRawLaser;
    if (kind != CarmenKind::kRawLaser) odometry_ = {}; // no RAWLASER line will be used, so none needs a pose
    const auto usable = check_usable(line.scan, options_);
    if (!usable) skip(record.line_number, usable.error().message);
    lines_.push_back({line.stamp, record.line_number, kind == CarmenKind::kRawLaser, usable.has_value()});
}

void Indexer::take(const CarmenRecord& record, const CarmenOdometry& odometry) {
    hash(record.text);
    if (!has_flaser_ && !has_robot_laser_) odometry_.push_back(odometry);
}

void Indexer::take(const CarmenRecord& record, const CarmenLaserOffset& offset) {
    hash(record.text);
    laser_offset_forward_ = offset.forward;
}

void Indexer::take(const CarmenRecord& record, const CarmenUnreadLaser& line) {
    auto& kind = unread_[line.kind];
    if (++kind.count == 1) kind.first_line = record.line_number;
}

void Indexer::hash(std::string_view line) {
    hash_.update(line);
    hash_.update("\n");
}

void Indexer::skip(std::size_t line_number, std::string reason) {
    ++skipped_;
    report_({line_number, std::move(reason)});
}

void Indexer::report_unread_kinds() {
    for (const auto& [kind, lines] : unread_) {
        skipped_ += lines.count;
        report_(
            {lines.first_line,
             fmt::format(
                 "{}: {} lines of an unsupported kind; supported are FLASER, ROBOTLASER1, ROBOTLASER2 and RAWLASER1",
                 kind, lines.count)});
    }
}

/// Drops the RAWLASER lines of logs that also have other laser lines: such logs contain every scan twice.
void Indexer::keep_one_view_of_each_scan() {
    if (!has_flaser_ && !has_robot_laser_) return;
    for (LaserLine& line : lines_) line.is_used = line.is_used && !line.is_raw;
}

void Indexer::drop_lines_without_pose(const PosePath& path) {
    for (LaserLine& line : lines_) {
        if (!line.is_used || !line.is_raw || path.at(line.stamp)) continue;
        line.is_used = false;
        skip(line.line_number, fmt::format("RAWLASER1: no ODOM line within {:g} s for its pose", kPoseGapMax));
    }
}

void Indexer::order_scans(CarmenIndex& index) {
    std::vector<std::uint32_t> used;
    std::vector<double> stamps;
    for (std::uint32_t i = 0; i < lines_.size(); ++i) {
        if (!lines_[i].is_used) continue;
        used.push_back(i);
        stamps.push_back(lines_[i].stamp);
    }
    const ScanOrder scans = order_of(stamps);
    index.scan_count = static_cast<std::uint32_t>(used.size());
    index.places.assign(lines_.size(), CarmenIndex::kUnused);
    for (std::uint32_t place = 0; place < used.size(); ++place) index.places[used[scans.order[place]]] = place;
    index.stamps = {scans.steps_back, scans.back_max, scans.is_of_file};
    if (!scans.is_of_stamps) hash_.update("with jitter in its place\n"); // "carmen 1" alone: strictly by stamp
}

/// Options count only if they change the scans: stating a default makes no difference.
std::string Indexer::fingerprint() {
    const auto hash_options = [&](std::string_view lines, CarmenKind kind, const std::string& range_max) {
        hash_.update(fmt::format("{} {} {}\n", lines, range_max,
                                 no_return_of(kind, options_) == NoReturn::kFree ? "free" : "drop"));
    };
    if (has_flaser_) {
        const double range_max = options_.range_max.value_or(kCarmenRangeMax);
        hash_options("flaser", CarmenKind::kFlaser, fmt::format("{}", range_max));
    }
    if (has_robot_laser_ || has_raw_) {
        hash_options("robotlaser", CarmenKind::kRobotLaser,
                     options_.range_max ? fmt::format("{}", *options_.range_max) : "as stated");
    }
    return "carmen:" + hash_.hex().substr(0, 32);
}

CarmenIndex Indexer::build() {
    CarmenIndex index;
    report_unread_kinds();
    keep_one_view_of_each_scan();
    index.path = PosePath(std::move(odometry_));
    drop_lines_without_pose(index.path);
    order_scans(index);
    index.fingerprint = fingerprint();
    index.laser_offset_forward = laser_offset_forward_;
    index.skipped_lines = skipped_;
    return index;
}

} // namespace

Result<CarmenIndex> index_carmen_log(const std::filesystem::path& path, const CarmenOptions& options,
                                     const std::function<void(const SkippedLine&)>& report, const OnRead& on_read) {
    auto records = CarmenRecords::open(path, options.limits, on_read);
    if (!records) return records.error();
    Indexer indexer(options, report);
    if (auto ok = indexer.read(*records); !ok) return ok.error();
    CarmenIndex index = indexer.build();
    if (index.scan_count > 0) return index;
    return Error{Errc::kNotFound,
                 fmt::format("{}: no usable scan in its {} lines ({} skipped); a CARMEN log with FLASER, ROBOTLASER1, "
                             "ROBOTLASER2 or RAWLASER1 lines is needed",
                             path.string(), records->line_count(), index.skipped_lines)};
}

} // namespace scanloom::robot
