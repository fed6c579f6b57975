#include "server/sessions/log_reconstruction.hpp"

#include "common/wire/messages.hpp"

#include <utility>
#include <variant>

namespace scanloom::sessions {
namespace {

/// Returns an empty scan, which fits every sensor.
Scan blank(const Scan& next, std::uint64_t seq) {
    Scan scan;
    scan.seq = seq;
    scan.stamp = next.stamp;
    scan.sensor = next.sensor;
    scan.pose = next.pose;
    scan.odometry = next.odometry;
    scan.ranges = {kInvalidRange};
    scan.angles = ExplicitAngles{0.0};
    return scan;
}

} // namespace

std::vector<LogEntry> LogReconstruction::add(Revision revision, LogEntry entry) {
    missing_ += revision - last_ - 1;
    last_ = revision;
    if (!renumber(entry)) return {};
    std::vector<LogEntry> entries;
    if (const auto* taken = std::get_if<ScanTaken>(&entry)) {
        if (!fits(*taken)) return {};
        entries = lost_before(*taken);
    }
    for (const auto& lost : entries) {
        if (!rules_.add(lost)) return {}; // cannot happen: their numbers are consecutive
        if (std::holds_alternative<ScanTaken>(lost)) ++empty_scans_;
    }
    if (!rules_.add(entry)) return {};
    if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
        sensors_[{described->robot, described->sensor.id}] = described->sensor;
    }
    entries.push_back(std::move(entry));
    return entries;
}

/// Replaces the robot's index by its new one. @return false if the RobotJoined entry of the robot is lost
bool LogReconstruction::renumber(LogEntry& entry) {
    if (auto* joined = std::get_if<RobotJoined>(&entry)) {
        joined->robot = robots_.emplace(joined->robot, static_cast<RobotIndex>(robots_.size())).first->second;
        return true;
    }
    RobotIndex* robot = nullptr;
    if (auto* described = std::get_if<SensorDescribed>(&entry)) robot = &described->robot;
    if (auto* taken = std::get_if<ScanTaken>(&entry)) robot = &taken->robot;
    if (auto* excluded = std::get_if<ScansExcluded>(&entry)) robot = &excluded->robot;
    if (auto* relocalized = std::get_if<RobotRelocalized>(&entry)) robot = &relocalized->robot;
    if (robot == nullptr) return true;
    const auto known = robots_.find(*robot);
    if (known == robots_.end()) return false;
    *robot = known->second;
    return true;
}

/// Returns whether the scan can be applied and the lost entries are enough to account for the scans missing before it.
bool LogReconstruction::fits(const ScanTaken& taken) const {
    const auto sensor = sensors_.find({taken.robot, taken.scan.sensor});
    if (sensor == sensors_.end() || !wire::check_scan(taken.scan, sensor->second)) return false;
    const auto last_seq = rules_.robots()[taken.robot].last_seq;
    return taken.scan.seq > last_seq && taken.scan.seq - last_seq - 1 <= missing_ - empty_scans_;
}

/// Returns the lost change of the mode, if the scan is of another one, and an empty scan for each lost one.
std::vector<LogEntry> LogReconstruction::lost_before(const ScanTaken& taken) const {
    std::vector<LogEntry> entries;
    if (taken.is_localize_only != rules_.is_localize_only()) entries.push_back(ModeChanged{taken.is_localize_only});
    for (auto seq = rules_.robots()[taken.robot].last_seq + 1; seq < taken.scan.seq; ++seq) {
        entries.emplace_back(std::in_place_type<ScanTaken>,
                             ScanTaken{taken.robot, blank(taken.scan, seq), taken.is_localize_only});
    }
    return entries;
}

} // namespace scanloom::sessions
