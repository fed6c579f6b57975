#include "common/scan/log_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

namespace scanloom {
namespace {

Error cannot_follow(std::string what) { return {Errc::kMalformed, std::move(what)}; }

} // namespace

Result<> LogRules::check(const LogEntry& entry) const {
    const auto follows = std::visit([this](const auto& body) { return check_body(body); }, entry);
    if (follows) return {};
    return Error{follows.error().code,
                 fmt::format("log entry {}: {}; the log is damaged", revision_ + 1, follows.error().message)};
}

void LogRules::apply(const LogEntry& entry) {
    std::visit([this](const auto& body) { apply_body(body); }, entry);
    ++revision_;
}

Result<> LogRules::add(const LogEntry& entry) {
    auto follows = check(entry);
    if (follows) apply(entry);
    return follows;
}

void LogRules::reset_robot(RobotIndex robot, LoggedRobot state) {
    robots_[robot] = std::move(state);
    const bool is_gone = (frame_origin_ == FrameOrigin::kSent && find_sender() == nullptr) ||
                         (frame_origin_ == FrameOrigin::kEstimated && find_estimated() == nullptr);
    if (!is_gone) return;
    frame_origin_ = is_localize_only_ && find_sender() == nullptr ? FrameOrigin::kOpen : origin_of_mapped();
}

/// Returns where the frame comes from if the robots' scans may change the map and have not begun it yet.
FrameOrigin LogRules::origin_of_mapped() const noexcept {
    if (find_sender() != nullptr) return FrameOrigin::kSent;
    return find_estimated() != nullptr ? FrameOrigin::kEstimated : FrameOrigin::kOpen;
}

const LoggedRobot* LogRules::find_robot(bool sends_poses) const noexcept {
    const auto found = std::ranges::find_if(robots_, [&](const LoggedRobot& robot) {
        return robot.last_seq > 0 && (robot.poses == Poses::kMap) == sends_poses;
    });
    return found == robots_.end() ? nullptr : &*found;
}

Result<> LogRules::check_body(const RobotJoined& joined) const {
    if (joined.robot == robots_.size()) return {};
    const bool is_again = joined.robot < robots_.size() && robots_[joined.robot].name == joined.name &&
                          robots_[joined.robot].accepts(joined.source, joined.poses);
    if (is_again) return {};
    return cannot_follow(fmt::format("robot {} joins after {} others", joined.robot, robots_.size()));
}

void LogRules::apply_body(const RobotJoined& joined) {
    if (joined.robot == robots_.size()) robots_.emplace_back().name = joined.name;
    robots_[joined.robot].source = joined.source;
    robots_[joined.robot].body_radius = joined.body_radius;
    robots_[joined.robot].poses = joined.poses;
}

Result<> LogRules::check_body(const SensorDescribed& described) const {
    if (described.robot < robots_.size()) return {};
    return cannot_follow(fmt::format("a sensor of robot {}, which never joined", described.robot));
}

void LogRules::apply_body(const SensorDescribed& described) {
    robots_[described.robot].sensors[described.sensor.id] = {revision_ + 1,
                                                             std::make_shared<const Sensor>(described.sensor)};
}

Result<> LogRules::check_body(const ScanTaken& taken) const {
    if (taken.robot >= robots_.size()) {
        return cannot_follow(fmt::format("a scan of robot {}, which never joined", taken.robot));
    }
    const LoggedRobot& robot = robots_[taken.robot];
    if (robot.find_sensor(taken.scan.sensor) == nullptr) {
        return cannot_follow(fmt::format("a scan of sensor {}, which was never described", taken.scan.sensor));
    }
    if (robot.poses == Poses::kMap && !taken.scan.pose) {
        return cannot_follow(fmt::format("scan {} of robot '{}' has no pose", taken.scan.seq, robot.name));
    }
    if (taken.is_localize_only != is_localize_only_) {
        return cannot_follow(fmt::format("scan {} of robot '{}' has localize_only={}, but the session's mode is {}",
                                         taken.scan.seq, robot.name, taken.is_localize_only, is_localize_only_));
    }
    if (robot.is_next(taken.scan.seq)) return {};
    return cannot_follow(
        fmt::format("scan {} of robot '{}' follows scan {}", taken.scan.seq, robot.name, robot.last_seq));
}

void LogRules::apply_body(const ScanTaken& taken) {
    LoggedRobot& robot = robots_[taken.robot];
    const bool is_sent = robot.poses == Poses::kMap;
    if (frame_origin_ == FrameOrigin::kOpen && is_sent && find_estimated() == nullptr) {
        frame_origin_ = FrameOrigin::kSent;
    }
    if (frame_origin_ == FrameOrigin::kOpen && !is_sent && !is_localize_only_) frame_origin_ = FrameOrigin::kEstimated;
    robot.last_seq = taken.scan.seq;
}

Result<> LogRules::check_body(const MapPatch&) const {
    if (robots_.empty()) return {};
    return cannot_follow("an imported map after robots have joined");
}

void LogRules::apply_body(const MapPatch& patch) {
    const auto is_known = [](MapCell cell) { return cell != MapCell::kUnknown; };
    if (std::ranges::any_of(patch.cells, is_known)) frame_origin_ = FrameOrigin::kImported;
}

Result<> LogRules::check_body(const ScansExcluded& excluded) const {
    if (excluded.robot < robots_.size()) return exclusions_.check(excluded);
    return cannot_follow(fmt::format("scans of robot {} are excluded, which never joined", excluded.robot));
}

void LogRules::apply_body(const ScansExcluded& excluded) {
    static_cast<void>(exclusions_.add(revision_ + 1, excluded));
}

Result<> LogRules::check_body(const ExclusionLifted& lifted) const { return exclusions_.check(lifted); }

Result<> LogRules::check_body(const MapsCorrected& corrected) const {
    if (corrected.as_of <= revision_) return {};
    return cannot_follow(fmt::format("maps are corrected as of entry {}", corrected.as_of));
}

void LogRules::apply_body(const MapsCorrected&) {}

Result<> LogRules::check_body(const RobotRelocalized& relocalized) const {
    if (relocalized.robot < robots_.size() && robots_[relocalized.robot].poses != Poses::kMap) return {};
    return cannot_follow(fmt::format("robot {} is relocalized, whose poses are not estimated", relocalized.robot));
}

void LogRules::apply_body(const RobotRelocalized&) {}

Result<> LogRules::check_body(const ModeChanged&) const { return {}; }

void LogRules::apply_body(const ModeChanged& changed) {
    is_localize_only_ = changed.is_localize_only;
    if (frame_origin_ == FrameOrigin::kOpen && !is_localize_only_) frame_origin_ = origin_of_mapped();
}

void LogRules::apply_body(const ExclusionLifted& lifted) { static_cast<void>(exclusions_.add(revision_ + 1, lifted)); }

} // namespace scanloom
