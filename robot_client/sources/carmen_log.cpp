#include "robot_client/sources/carmen_log.hpp"

#include "common/hash/sha256.hpp"
#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace scanloom::robot {

namespace {

/// The place of a laser line that is not sent.
constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

struct LaserLine {
    double stamp = 0.0;
    std::size_t line_number = 0;
    bool is_raw = false;
    bool is_used = false;
};

/// Finds the mount of the laser from the two poses of each FLASER line.
class FlaserMount {
public:
    void add(const CarmenScan& line) {
        const Pose2 mount = compose(inverse(line.robot), line.laser);
        if (!first_) first_ = mount;
        const double difference = std::max({std::abs(mount.x - first_->x), std::abs(mount.y - first_->y),
                                            std::abs(normalize_angle(mount.yaw - first_->yaw))});
        is_constant_ = is_constant_ && difference <= kConstantMountTolerance;
    }

    /// Returns T_robot_laser; the identity if it is not constant, or farther than a sensor may be from its robot.
    [[nodiscard]] Pose2 value() const {
        if (!first_ || !is_constant_) return {};
        return std::max(std::abs(first_->x), std::abs(first_->y)) <= kCoordinateMax ? *first_ : Pose2{};
    }

private:
    std::optional<Pose2> first_;
    bool is_constant_ = true;
};

} // namespace

Result<std::optional<CarmenLog::Line>> CarmenLog::Lines::next() {
    for (;;) {
        const auto line = reader.next();
        if (!line) return line.error();
        if (!*line) return std::optional<Line>{};
        auto content = parse_carmen_line(**line);
        if (content && std::holds_alternative<std::monostate>(*content)) continue;
        auto* scan = content ? std::get_if<CarmenScan>(&*content) : nullptr;
        if (scan != nullptr) scan->stamp = last_stamp = scan->stamp.value_or(last_stamp);
        return std::optional(Line{**line, std::move(content)});
    }
}

class CarmenLog::Indexer {
public:
    Indexer(const CarmenOptions& options, const std::function<void(const SkippedLine&)>& report)
        : options_(options), report_(report) {
        hash_.update("carmen 1\n"); // increase it when the same lines give different scans
    }

    [[nodiscard]] Result<> read(Lines& lines);
    [[nodiscard]] Index build();

private:
    void take(std::size_t line_number, const CarmenScan& scan);
    void take(std::size_t line_number, const CarmenOdometry& odometry);
    void take(std::size_t line_number, const CarmenLaserOffset& offset);
    void take(std::size_t line_number, const CarmenUnreadLaser& line);
    void take(std::size_t, std::monostate) {}
    void skip(std::size_t line_number, std::string reason);
    void report_unread_kinds();
    void keep_one_view_of_each_scan();
    void drop_lines_without_pose(const PosePath& path);
    void order_scans(Index& index);
    [[nodiscard]] std::string fingerprint();

    const CarmenOptions& options_;
    const std::function<void(const SkippedLine&)>& report_;
    Sha256 hash_;
    std::vector<LaserLine> lines_;
    std::vector<StampedPose> odometry_;
    double raw_laser_forward_ = 0.0;
    FlaserMount flaser_mount_;
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

Result<> CarmenLog::Indexer::read(Lines& lines) {
    for (;;) {
        const auto line = lines.next();
        if (!line) return line.error();
        if (!*line) return {};
        const std::size_t line_number = lines.reader.line_number();
        const auto& [text, content] = **line;
        if (!content) {
            skip(line_number, content.error().message);
            continue;
        }
        if (!std::holds_alternative<CarmenUnreadLaser>(*content)) {
            hash_.update(text);
            hash_.update("\n");
        }
        std::visit([&](const auto& one) { take(line_number, one); }, *content);
        if (lines_.size() == kUnused) {
            return Error{Errc::kTooLarge, fmt::format("more than {} laser lines; split the log", lines_.size() - 1)};
        }
    }
}

void CarmenLog::Indexer::take(std::size_t line_number, const CarmenScan& scan) {
    has_flaser_ |= scan.kind == CarmenKind::kFlaser;
    has_robot_laser_ |= scan.kind == CarmenKind::kRobotLaser;
    const bool is_raw = scan.kind == CarmenKind::kRawLaser;
    has_raw_ |= is_raw;
    if (!is_raw) odometry_ = {}; // no RAWLASER line will be used, so none needs a pose
    const auto usable = check_usable(scan, options_);
    if (!usable) skip(line_number, usable.error().message);
    if (usable && scan.kind == CarmenKind::kFlaser && options_.poses != Poses::kMap) flaser_mount_.add(scan);
    lines_.push_back({*scan.stamp, line_number, is_raw, usable.has_value()});
}

void CarmenLog::Indexer::take(std::size_t, const CarmenOdometry& odometry) {
    if (!has_flaser_ && !has_robot_laser_) odometry_.push_back(odometry);
}

void CarmenLog::Indexer::take(std::size_t, const CarmenLaserOffset& offset) { raw_laser_forward_ = offset.forward; }

void CarmenLog::Indexer::take(std::size_t line_number, const CarmenUnreadLaser& line) {
    auto& kind = unread_[line.kind];
    if (++kind.count == 1) kind.first_line = line_number;
}

void CarmenLog::Indexer::skip(std::size_t line_number, std::string reason) {
    ++skipped_;
    report_({line_number, std::move(reason)});
}

void CarmenLog::Indexer::report_unread_kinds() {
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
void CarmenLog::Indexer::keep_one_view_of_each_scan() {
    if (!has_flaser_ && !has_robot_laser_) return;
    for (LaserLine& line : lines_) line.is_used = line.is_used && !line.is_raw;
}

void CarmenLog::Indexer::drop_lines_without_pose(const PosePath& path) {
    for (LaserLine& line : lines_) {
        if (!line.is_used || !line.is_raw || path.at(line.stamp)) continue;
        line.is_used = false;
        skip(line.line_number, fmt::format("RAWLASER1: no ODOM line within {:g} s for its pose", kPoseGapMax));
    }
}

void CarmenLog::Indexer::order_scans(Index& index) {
    std::vector<std::uint32_t> used;
    std::vector<double> stamps;
    for (std::uint32_t i = 0; i < lines_.size(); ++i) {
        if (!lines_[i].is_used) continue;
        used.push_back(i);
        stamps.push_back(lines_[i].stamp);
    }
    const ScanOrder scans = order_of(stamps);
    index.scan_count = static_cast<std::uint32_t>(used.size());
    index.places.assign(lines_.size(), kUnused);
    for (std::uint32_t place = 0; place < used.size(); ++place) index.places[used[scans.order[place]]] = place;
    index.stamps = static_cast<const StampReport&>(scans);
    if (!scans.is_of_stamps) hash_.update("with jitter in its place\n");     // "carmen 1" alone: strictly by stamp
    if (scans.is_clock_set_back) hash_.update("in the order of the file\n"); // earlier clients sorted these
}

/// Options count only if they change the scans: stating a default makes no difference.
std::string CarmenLog::Indexer::fingerprint() {
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
    if (options_.poses != Poses::kMap) {
        hash_.update(fmt::format("poses {}\n", name_of(options_.poses)));
    }
    return "carmen:" + hash_.hex().substr(0, 32);
}

CarmenLog::Index CarmenLog::Indexer::build() {
    Index index;
    report_unread_kinds();
    keep_one_view_of_each_scan();
    index.path = PosePath(std::move(odometry_));
    if (options_.poses != Poses::kNone) drop_lines_without_pose(index.path);
    order_scans(index);
    index.fingerprint = fingerprint();
    index.mounts = {raw_laser_forward_, flaser_mount_.value()};
    index.skipped_lines = skipped_;
    return index;
}

Result<CarmenLog> CarmenLog::open(const std::filesystem::path& path, const CarmenOptions& options,
                                  const std::function<void(const SkippedLine&)>& report, const OnRead& on_read) {
    auto reader = LineReader::open(path, options.limits, on_read);
    if (!reader) return reader.error();
    Lines lines{std::move(*reader)};
    Indexer indexer(options, report);
    if (auto ok = indexer.read(lines); !ok) return ok.error();
    Index index = indexer.build();
    if (index.scan_count == 0) {
        if (lines.reader.line_number() == 0) {
            return Error{Errc::kNotFound, fmt::format("{}: the file is empty", path.string())};
        }
        return Error{Errc::kNotFound,
                     fmt::format("{}: no usable scan in its {} lines ({} skipped); a CARMEN log with FLASER, "
                                 "ROBOTLASER1, ROBOTLASER2 or RAWLASER1 lines is needed",
                                 path.string(), lines.reader.line_number(), index.skipped_lines)};
    }
    auto again = LineReader::open(path, options.limits);
    if (!again) return again.error();
    return CarmenLog(path, options, std::move(index), std::move(*again));
}

CarmenLog::CarmenLog(const std::filesystem::path& path, const CarmenOptions& options, Index index, LineReader reader)
    : path_(path.string()), index_(std::move(index)), lines_{std::move(reader)},
      needs_poses_(options.poses != Poses::kNone), observer_(options, index_.mounts) {}

Result<std::optional<Observation>> CarmenLog::next() {
    if (place_ == index_.scan_count) return std::optional<Observation>{};
    auto scan = next_in_place();
    if (!scan) return scan.error();
    if (scan->kind == CarmenKind::kRawLaser && needs_poses_) {
        const auto pose = index_.path.at(*scan->stamp);
        if (!pose) return changed();
        scan->robot = *pose;
    }
    auto observation = observer_.observe(*scan);
    if (!observation) return changed();
    ++place_;
    return std::optional(std::move(*observation));
}

Result<CarmenScan> CarmenLog::next_in_place() {
    if (auto early = early_.extract(place_)) return std::move(early.mapped());
    for (;;) {
        auto line = lines_.next();
        if (!line) return line.error();
        if (!*line) return changed();
        auto& content = (*line)->content;
        auto* scan = content ? std::get_if<CarmenScan>(&*content) : nullptr;
        if (scan == nullptr) continue;
        if (laser_lines_ == index_.places.size()) return changed();
        const std::uint32_t place = index_.places[laser_lines_++];
        if (place == kUnused) continue;
        if (place == place_) return std::move(*scan);
        early_.emplace(place, std::move(*scan));
    }
}

Error CarmenLog::changed() const {
    return {Errc::kConflict, fmt::format("{}: the file was changed during the transfer, so the stored scans may be "
                                         "wrong: send the whole file to a new --session",
                                         path_)};
}

} // namespace scanloom::robot
