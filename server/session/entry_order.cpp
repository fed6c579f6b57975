#include "server/session/entry_order.hpp"

#include <fmt/format.h>

#include <variant>

namespace scanloom::session {

Result<> EntryOrder::add(const LogEntry& entry) {
    auto follows = std::visit([this](const auto& body) { return check(body); }, entry);
    if (follows) ++revision_;
    return follows;
}

Error EntryOrder::misplaced(const std::string& what) const {
    return {Errc::kMalformed, fmt::format("log entry {}: {}; the log is damaged", revision_ + 1, what)};
}

Result<> EntryOrder::check(const RobotJoined& joined) {
    const bool again = joined.robot < robots_.size() && robots_[joined.robot].name == joined.name &&
                       (robots_[joined.robot].last_seq == 0 || robots_[joined.robot].source == joined.source);
    if (joined.robot != robots_.size() && !again) {
        return misplaced(fmt::format("robot {} joins after {} others", joined.robot, robots_.size()));
    }
    if (!again) robots_.emplace_back().name = joined.name;
    robots_[joined.robot].source = joined.source;
    return {};
}

Result<> EntryOrder::check(const SensorDescribed& described) {
    if (described.robot >= robots_.size()) {
        return misplaced(fmt::format("a sensor of robot {}, which never joined", described.robot));
    }
    robots_[described.robot].sensors.insert(described.sensor.id);
    return {};
}

Result<> EntryOrder::check(const ScanTaken& taken) {
    if (taken.robot >= robots_.size()) {
        return misplaced(fmt::format("a scan of robot {}, which never joined", taken.robot));
    }
    auto& robot = robots_[taken.robot];
    if (!robot.sensors.contains(taken.scan.sensor)) {
        return misplaced(fmt::format("a scan of sensor {}, which was never described", taken.scan.sensor));
    }
    if (taken.scan.seq != robot.last_seq + 1) {
        return misplaced(
            fmt::format("scan {} of robot '{}' follows scan {}", taken.scan.seq, robot.name, robot.last_seq));
    }
    robot.last_seq = taken.scan.seq;
    return {};
}

Result<> EntryOrder::check(const MapPatch&) {
    if (!robots_.empty()) return misplaced("an imported map after robots have joined");
    return {};
}

Result<> EntryOrder::check(const ScansExcluded& excluded) {
    if (excluded.robot >= robots_.size()) {
        return misplaced(fmt::format("scans of robot {} are excluded, which never joined", excluded.robot));
    }
    const auto added = exclusions_.add(revision_ + 1, excluded);
    return added ? added : misplaced(added.error().message);
}

Result<> EntryOrder::check(const ExclusionLifted& lifted) {
    const auto added = exclusions_.add(revision_ + 1, lifted);
    return added ? added : misplaced(added.error().message);
}

} // namespace scanloom::session
