#include "server/exchange/carmen_text.hpp"

#include "common/geometry/pose2.hpp"
#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <variant>

namespace scanloom::exchange {
namespace {

/// By default, replay treats longer readings of a CARMEN log as no return.
constexpr double kBelievedRange = 50.0; // metres

/// Replay keeps the order of lines whose stamps go back by no more than this.
constexpr double kStampJitter = 2.0; // seconds

Error beyond_carmen(const std::string& robot, const Sensor& sensor, std::string_view what) {
    return {Errc::kConflict, fmt::format("sensor {} of robot '{}' {}, which a CARMEN log cannot represent; request the "
                                         "log without format=clf",
                                         sensor.id, robot, what)};
}

Result<> check_representable(const std::string& robot, const Sensor& sensor, const BeamAngles& angles) {
    if (sensor.kind != SensorKind::kLaser) return beyond_carmen(robot, sensor, "is a ring of sonars");
    if (!std::holds_alternative<UniformAngles>(angles)) {
        return beyond_carmen(robot, sensor, "has beams that are not evenly spaced");
    }
    if (sensor.aperture > 0.0) return beyond_carmen(robot, sensor, "has its own aperture");
    return {};
}

/// Appends a range so that replay reads it back as the same reading.
void append_range(std::string& line, RangeMm range, const Sensor& sensor) {
    const double metres = range * 0.001;
    if (range == kInvalidRange || (range != kNoReturn && metres < sensor.range_min)) {
        line += " 0";
    } else if (range == kNoReturn || metres >= sensor.range_max) {
        fmt::format_to(std::back_inserter(line), " {}", sensor.range_max);
    } else {
        fmt::format_to(std::back_inserter(line), " {}.{:03}", range / 1000, range % 1000);
    }
}

} // namespace

std::string CarmenText::head(const std::string& session) {
    return fmt::format("# CARMEN log of Scanloom's session {}\n"
                       "# Both poses of a line are the laser's in the map; the host is the robot.\n",
                       session);
}

Result<std::string> CarmenText::lines(const LogEntry& entry) {
    ++revision_;
    return std::visit([&](const auto& body) { return text_of(body); }, entry);
}

Result<std::string> CarmenText::text_of(const RobotJoined& joined) {
    if (joined.robot >= robots_.size()) robots_.resize(joined.robot + 1);
    robots_[joined.robot] = joined.name;
    return std::string();
}

Result<std::string> CarmenText::text_of(const SensorDescribed& described) {
    sensors_[{described.robot, described.sensor.id}] = described.sensor;
    if (described.sensor.range_max <= kBelievedRange) return std::string();
    return fmt::format("# replay with --max-range {}: what each line states is then believed\n", kRangeMax);
}

Result<std::string> CarmenText::text_of(const MapPatch&) {
    return Error{Errc::kConflict, "the session begins with an imported map, which a CARMEN log cannot represent; "
                                  "request the log without format=clf"};
}

Result<std::string> CarmenText::text_of(const ScanTaken& taken) {
    const Scan& scan = taken.scan;
    const auto known = sensors_.find({taken.robot, scan.sensor});
    if (known == sensors_.end() || taken.robot >= robots_.size()) {
        return Error{Errc::kMalformed,
                     fmt::format("scan {} is of sensor {}, which was not described", scan.seq, scan.sensor)};
    }
    if (filter_.take(revision_, scan_pose_of(taken)) != ScanUse::kIntegrated) return std::string();
    const Sensor& sensor = known->second;
    const auto& robot = robots_[taken.robot];
    const BeamAngles angles = angles_of(scan, sensor);
    if (auto valid = check_representable(robot, sensor, angles); !valid) return valid.error();

    const auto& uniform = std::get<UniformAngles>(angles);
    const Pose2 laser = compose(*scan.pose, sensor.mount);
    const auto count = scan.ranges.size();
    const double fov = uniform.increment * static_cast<double>(count == 0 ? 0 : count - 1);
    const bool goes_back = scan.stamp < latest_ - kStampJitter;
    const double stamp = goes_back ? latest_ : scan.stamp;
    latest_ = std::max(latest_, stamp);
    std::string line;
    if (goes_back) line = fmt::format("# the next line's own stamp is {}, by another clock\n", scan.stamp);
    fmt::format_to(std::back_inserter(line), "ROBOTLASER1 0 {} {} {} {} 0 0 {}", uniform.first, fov, uniform.increment,
                   sensor.range_max, count);
    line.reserve(line.size() + 8 * count + 256);
    for (const RangeMm range : scan.ranges) append_range(line, range, sensor);
    fmt::format_to(std::back_inserter(line), " 0 {0} {1} {2} {0} {1} {2} 0 0 0 0 0 {3} {4} {3}\n", laser.x, laser.y,
                   laser.yaw, stamp, robot);
    return line;
}

} // namespace scanloom::exchange
