#include "robot_client/source/carmen_log.hpp"

#include "robot_client/source/carmen_line.hpp"
#include "robot_client/source/carmen_observation.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::robot {
namespace {

/// A RAWLASER line this far in time from the nearest ODOM line has no pose.
constexpr double kOdometryGapMax = 1.0; // seconds

struct StampedLine {
    CarmenScan scan;
    double stamp = 0.0;
    std::size_t line_number = 0;
};

struct Lines {
    std::vector<StampedLine> scans;
    std::vector<CarmenOdometry> odometry;
    double laser_offset_forward = 0.0;
    std::size_t line_count = 0;
};

class LogBuilder {
public:
    LogBuilder(const CarmenOptions& options, const std::function<void(const SkippedLine&)>& report)
        : options_(options), report_(report) {}

    [[nodiscard]] Result<> read(LineReader& reader);
    [[nodiscard]] CarmenLog build();
    [[nodiscard]] std::size_t line_count() const { return lines_.line_count; }

private:
    void take(CarmenLine line, std::size_t line_number);
    void skip(std::size_t line_number, std::string reason);
    void keep_one_view_of_each_scan();
    [[nodiscard]] bool place(StampedLine& line) const;

    const CarmenOptions& options_;
    const std::function<void(const SkippedLine&)>& report_;
    Lines lines_;
    double last_stamp_ = 0.0;
    std::size_t skipped_ = 0;
};

Result<> LogBuilder::read(LineReader& reader) {
    for (;;) {
        auto line = reader.next();
        if (!line) return line.error();
        if (!*line) break;
        lines_.line_count = reader.line_number();
        auto parsed = parse_carmen_line(**line);
        if (parsed) {
            take(std::move(*parsed), reader.line_number());
        } else {
            skip(reader.line_number(), parsed.error().message);
        }
    }
    return {};
}

void LogBuilder::take(CarmenLine line, std::size_t line_number) {
    if (auto* scan = std::get_if<CarmenScan>(&line)) {
        last_stamp_ = scan->stamp.value_or(last_stamp_);
        lines_.scans.push_back({std::move(*scan), last_stamp_, line_number});
    } else if (const auto* odometry = std::get_if<CarmenOdometry>(&line)) {
        lines_.odometry.push_back(*odometry);
    } else if (const auto* offset = std::get_if<CarmenLaserOffset>(&line)) {
        lines_.laser_offset_forward = offset->forward;
    }
}

void LogBuilder::skip(std::size_t line_number, std::string reason) {
    ++skipped_;
    report_({line_number, std::move(reason)});
}

/// Logs that hold RAWLASER and ROBOTLASER lines hold every scan twice.
void LogBuilder::keep_one_view_of_each_scan() {
    const auto is_raw = [](const StampedLine& line) { return line.scan.kind == CarmenKind::kRawLaser; };
    if (std::all_of(lines_.scans.begin(), lines_.scans.end(), is_raw)) return;
    std::erase_if(lines_.scans, is_raw);
}

/// Gives a RAWLASER line the robot's pose at its time. Pre: odometry is sorted by stamp.
bool LogBuilder::place(StampedLine& line) const {
    const auto& samples = lines_.odometry;
    const auto after =
        std::lower_bound(samples.begin(), samples.end(), line.stamp,
                         [](const CarmenOdometry& sample, double stamp) { return sample.stamp < stamp; });
    const auto is_near = [&](auto at) { return std::abs(at->stamp - line.stamp) <= kOdometryGapMax; };
    const bool has_after = after != samples.end() && is_near(after);
    const bool has_before = after != samples.begin() && is_near(after - 1);
    if (!has_after && !has_before) return false;
    const CarmenOdometry& from = has_before ? *(after - 1) : *after;
    const CarmenOdometry& to = has_after ? *after : *(after - 1);
    const double gap = to.stamp - from.stamp;
    const double share = gap > 0.0 ? (line.stamp - from.stamp) / gap : 0.0;
    line.scan.robot = {from.robot.x + share * (to.robot.x - from.robot.x),
                       from.robot.y + share * (to.robot.y - from.robot.y),
                       normalize_angle(from.robot.yaw + share * normalize_angle(to.robot.yaw - from.robot.yaw))};
    return true;
}

CarmenLog LogBuilder::build() {
    keep_one_view_of_each_scan();
    const auto by_stamp = [](const auto& a, const auto& b) { return a.stamp < b.stamp; };
    std::stable_sort(lines_.scans.begin(), lines_.scans.end(), by_stamp);
    std::stable_sort(lines_.odometry.begin(), lines_.odometry.end(), by_stamp);

    CarmenLog log;
    log.observations.reserve(lines_.scans.size());
    CarmenObserver observer(options_, lines_.laser_offset_forward);
    for (StampedLine& line : lines_.scans) {
        if (line.scan.kind == CarmenKind::kRawLaser && !place(line)) {
            skip(line.line_number,
                 fmt::format("RAWLASER1: no ODOM line within {:g} s tells its pose", kOdometryGapMax));
            continue;
        }
        auto observation = observer.observe(line.scan, line.stamp);
        if (observation) {
            log.observations.push_back(std::move(*observation));
        } else {
            skip(line.line_number, observation.error().message);
        }
        line.scan.ranges = {}; // the millimetres replace them; a long log need not be held twice
    }
    log.skipped_lines = skipped_;
    return log;
}

} // namespace

Result<CarmenLog> read_carmen_log(const std::filesystem::path& path, const CarmenOptions& options,
                                  const std::function<void(const SkippedLine&)>& report) {
    auto reader = LineReader::open(path, options.limits);
    if (!reader) return reader.error();
    LogBuilder builder(options, report);
    if (auto ok = builder.read(*reader); !ok) return ok.error();
    CarmenLog log = builder.build();
    if (log.observations.empty()) {
        return Error{
            Errc::kNotFound,
            fmt::format("{}: no usable scan in its {} lines ({} skipped); a CARMEN log with FLASER, ROBOTLASER1, "
                        "ROBOTLASER2 or RAWLASER1 lines is needed",
                        path.string(), builder.line_count(), log.skipped_lines)};
    }
    return log;
}

} // namespace scanloom::robot
