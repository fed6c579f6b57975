#include "server/sessions/robot_sequencer.hpp"

#include "common/wire/messages.hpp"
#include "core/localization/mount_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::sessions {
namespace {

constexpr std::size_t kRobotsMax = 1024; // per session

Error map_already_begun(const std::string& robot, const std::string& session) {
    return {Errc::kConflict,
            fmt::format("begins_map: robot '{}' was to begin the map of session '{}' from a given pose, but the "
                        "session has a map by now, and the pose of one relative to the other is not known: give the "
                        "robot's pose again, or send these scans to another session",
                        robot, session)};
}

} // namespace

void RobotSequencer::restore(const mapping::ProjectionState& state) {
    members_.resize(state.robots.size());
    for (RobotIndex robot = 0; robot < members_.size(); ++robot) restore(robot, state.robots[robot]);
    pending_ = LogRules(state.revision, {state.robots.begin(), state.robots.end()}, {}, state.is_localize_only,
                        state.frame_origin);
}

/// Sets a member to its durable state, and counts the scans that are dropped. pending_ is not changed.
void RobotSequencer::restore(RobotIndex robot, const LoggedRobot& durable) {
    const std::uint64_t last_seq = robot < pending_.robots().size() ? pending_.robots()[robot].last_seq : 0;
    counters_.scans_dropped += last_seq - std::min(last_seq, durable.last_seq);
    Member& member = members_[robot];
    member.durable_seq = durable.last_seq;
    if (member.first_visible_seq > durable.last_seq) member.first_visible_seq = 0;
    member.pending_entries = 0;
}

RobotIndex RobotSequencer::index_of(const Member& member) const {
    return static_cast<RobotIndex>(&member - members_.data());
}

RobotSequencer::Member* RobotSequencer::member_of(const std::shared_ptr<RobotListener>& listener) {
    const auto member =
        std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.listener == listener; });
    return member == members_.end() ? nullptr : &*member;
}

PendingEntry RobotSequencer::submitted(Member& member, std::optional<LogEntry> entry, std::size_t bytes) {
    if (entry) pending_.apply(*entry);
    ++member.pending_entries;
    return {index_of(member), std::move(entry), {}, bytes};
}

// Joining and leaving

std::optional<PendingEntry> RobotSequencer::join(PendingJoin joining) {
    const auto& who = joining.who;
    auto known =
        std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return logged(m).name == who.robot; });
    if (known == members_.end() && members_.size() >= kRobotsMax) {
        joining.done(
            Error{Errc::kFull, fmt::format("session '{}' has {} robots already, the limit; use another session",
                                           info_.name, members_.size())});
        return std::nullopt;
    }
    const bool is_new = known == members_.end();
    auto agrees = is_new ? Result<>() : check_again(logged(*known), who);
    if (agrees) {
        if (auto fits = check_frame(who.robot, who.poses); !fits) agrees = prefixed("hello.poses: ", fits.error());
    }
    if (!agrees) {
        joining.done(agrees.error());
        return std::nullopt;
    }
    Member& member = is_new ? members_.emplace_back() : *known;
    if (!is_new) {
        fail(member, {Errc::kReplaced, fmt::format("robot '{}' of session '{}' connected again; this link is closed",
                                                   who.robot, info_.name)});
    }
    std::optional<PendingEntry> entry;
    const auto is_as_logged = [&](const LoggedRobot& robot) {
        return robot.source == who.source && robot.body_radius == who.body_radius && robot.poses == who.poses;
    };
    if (is_new || !is_as_logged(logged(member))) {
        entry = submitted(member, RobotJoined{index_of(member), who.robot, who.source, who.body_radius, who.poses}, 0);
    }
    member.joining = std::move(joining);
    admit(member);
    return entry;
}

/// Checks that a robot continues with the same source and the same kind of poses. Scans are identified by their
/// sequence number only, so the scans of another recording would be taken for the rest of this one.
Result<> RobotSequencer::check_again(const LoggedRobot& robot, const JoinRequest& who) const {
    if (robot.accepts(who.source, who.poses)) return {};
    if (robot.source == who.source) {
        return Error{Errc::kConflict,
                     fmt::format("hello.poses: the {} scans of robot '{}' in session '{}' have poses of kind '{}', not "
                                 "'{}'; continue with the same, or use another robot or session name",
                                 robot.last_seq, robot.name, info_.name, name_of(robot.poses), name_of(who.poses))};
    }
    const auto in_words = [](const std::string& name) { return name.empty() ? "a live robot" : "'" + name + "'"; };
    return Error{Errc::kConflict,
                 fmt::format("hello.source: the {} scans of robot '{}' in session '{}' come from {}, not from {}; "
                             "continue with the same, or use another robot or session name",
                             robot.last_seq, robot.name, info_.name, in_words(robot.source), in_words(who.source))};
}

/// Checks that poses which a robot sends can be in the map's frame. They cannot if the server estimated the first ones,
/// because only the server knows that frame. In a map that does not change, wrong poses do no harm.
Result<> RobotSequencer::check_frame(const std::string& robot, Poses poses) const {
    const bool fits =
        poses != Poses::kMap || pending_.frame_origin() != FrameOrigin::kEstimated || pending_.is_localize_only();
    if (fits) return {};
    return Error{Errc::kConflict,
                 fmt::format("robot '{}' sends poses in the map's frame, but the map of session '{}' began with "
                             "estimated poses of robot '{}', and only the server knows their frame; use --poses "
                             "odometry or none, or another session",
                             robot, info_.name, pending_.find_estimated()->name)};
}

/// Admits the link that waits to join, if all entries of the robot's earlier links are in the maps.
void RobotSequencer::admit(Member& member) {
    if (!member.joining || member.pending_entries > 0) return;
    const auto joining = *std::exchange(member.joining, std::nullopt);
    member.listener = joining.listener;
    set_connected(member, true);
    Joined joined{index_of(member), member.durable_seq};
    for (const auto& [id, known] : logged(member).sensors) joined.sensors.insert(id);
    joining.done(std::move(joined));
}

void RobotSequencer::leave(const std::shared_ptr<RobotListener>& listener) {
    Member* member = member_of(listener);
    if (member == nullptr) return;
    member->listener.reset();
    set_connected(*member, false);
}

void RobotSequencer::fail(Member& member, const Error& error) {
    if (const auto joining = std::exchange(member.joining, std::nullopt)) joining->done(error);
    if (!member.listener) return;
    const auto listener = std::move(member.listener);
    member.listener.reset();
    set_connected(member, false);
    listener->on_failed(error);
}

void RobotSequencer::fail_all(const Error& error) {
    for (auto& member : members_) fail(member, error);
}

void RobotSequencer::refuse(RobotIndex robot, const Error& error, const mapping::ProjectionState& state) {
    restore(robot, state.robots[robot]);
    pending_.reset_robot(robot, state.robots[robot]);
    fail(members_[robot], error);
}

bool RobotSequencer::is_connected(RobotIndex robot) const {
    const std::lock_guard lock(connected_mutex_);
    return robot < connected_.size() && connected_[robot];
}

std::vector<bool> RobotSequencer::connected() const {
    const std::lock_guard lock(connected_mutex_);
    return connected_;
}

void RobotSequencer::set_connected(const Member& member, bool connected) {
    ++connection_changes_;
    const std::lock_guard lock(connected_mutex_);
    connected_.resize(std::max(connected_.size(), members_.size()));
    connected_[index_of(member)] = connected;
}

// Entries

std::vector<PendingEntry> RobotSequencer::describe(const std::shared_ptr<RobotListener>& from, Sensor sensor,
                                                   std::size_t bytes) {
    std::vector<PendingEntry> entries;
    Member* member = member_of(from);
    if (member == nullptr) return entries;
    auto ok = mapping::check_reach(info_.config, sensor);
    if (ok && logged(*member).poses != Poses::kMap) ok = localization::check_mount(sensor);
    if (!ok) {
        fail(*member, prefixed("sensor_description.", ok.error()));
        return entries;
    }
    std::optional<LogEntry> entry;
    const auto* known = logged(*member).find_sensor(sensor.id);
    if (known == nullptr || *known->sensor != sensor) {
        entry = SensorDescribed{index_of(*member), std::move(sensor)};
    }
    entries.push_back(submitted(*member, std::move(entry), bytes));
    return entries;
}

std::vector<PendingEntry> RobotSequencer::take(const std::shared_ptr<RobotListener>& from, std::vector<Scan> scans,
                                               std::size_t bytes, bool is_mapped) {
    std::vector<PendingEntry> entries;
    Member* member = member_of(from);
    if (member == nullptr) { // the link failed or was replaced; the robot sends them again
        counters_.scans_dropped += scans.size();
        return entries;
    }
    std::optional<Error> fault;
    std::size_t n = 0;
    for (; n < scans.size() && !fault; ++n) {
        Scan& scan = scans[n];
        if (scan.seq <= logged(*member).last_seq) { // sent again after a reconnect
            ++counters_.scans_duplicates;
            continue;
        }
        if (auto ok = check_next(logged(*member), scan, is_mapped); !ok) {
            fault = prefixed(fmt::format("scan_batch.scans[{}].", n), ok.error());
            continue;
        }
        const auto reach = reach_of(*member, scan);
        if (auto ok = mapping::check_work(reach); !ok) {
            fault = prefixed(fmt::format("scan_batch.scans[{}].", n), ok.error());
            continue;
        }
        if (member->first_visible_seq == 0 && !reach.cells.empty()) member->first_visible_seq = scan.seq;
        entries.push_back(
            submitted(*member, ScanTaken{index_of(*member), std::move(scan), pending_.is_localize_only()}, 0));
        entries.back().reach = reach;
    }
    if (fault) counters_.scans_dropped += scans.size() - (n - 1); // the invalid scan and those after it
    if (entries.empty()) entries.push_back(submitted(*member, std::nullopt, 0));
    entries.back().bytes = bytes;     // returned when the whole frame is in the maps
    if (fault) fail(*member, *fault); // the scans before it are accepted
    return entries;
}

/// Returns what a scan may change. Without a pose, it counts as taken where the robot is expected.
mapping::Reach RobotSequencer::reach_of(const Member& member, Scan& scan) const {
    const bool is_estimated = !scan.pose;
    if (is_estimated) {
        scan.pose = scan.odometry ? compose(member.location.T_map_odom, *scan.odometry) : member.location.T_map_robot;
    }
    auto reach = mapping::reach_of(info_.config, *logged(member).find_sensor(scan.sensor)->sensor, scan);
    if (is_estimated) scan.pose.reset();
    if (pending_.is_localize_only()) reach.cells = {};
    return reach;
}

/// Checks that a scan has the poses that its robot announced.
Result<> RobotSequencer::check_pose(const LoggedRobot& robot, const Scan& scan) {
    const auto invalid = [](std::string_view why) { return Error{Errc::kInvalidField, std::string(why)}; };
    if (robot.poses == Poses::kMap) {
        if (scan.pose) return {};
        return invalid("pose is absent; send where the robot was, an empty Pose2 if that is (0, 0, 0)");
    }
    if (scan.pose)
        return invalid("pose is set, but hello.poses says that the server estimates the poses; leave it out");
    if (robot.poses == Poses::kOdometry) {
        if (scan.odometry) return {};
        return invalid("odometry is absent, but hello.poses says that the robot has odometry; send it, or POSES_NONE");
    }
    if (scan.odometry) return invalid("odometry is set, but hello.poses says that the robot has none; leave it out");
    const auto is_laser = [](const auto& known) { return known.second.sensor->kind == SensorKind::kLaser; };
    if (std::ranges::any_of(robot.sensors, is_laser)) return {};
    return invalid("sensor is a ring of sonars of a robot without laser and odometry, whose poses cannot be estimated");
}

Result<> RobotSequencer::check_next(const LoggedRobot& robot, const Scan& scan, bool is_mapped) const {
    if (!robot.is_next(scan.seq)) {
        return Error{
            Errc::kOutOfOrder,
            fmt::format("seq is {}, {} is the next of robot '{}'; connect again and continue after last_durable_seq",
                        scan.seq, robot.last_seq + 1, robot.name)};
    }
    const auto* known = robot.find_sensor(scan.sensor);
    if (known == nullptr) {
        return Error{Errc::kInvalidField,
                     fmt::format("sensor is {}, which was not described; send a SensorDescription first", scan.sensor)};
    }
    if (auto ok = check_pose(robot, scan); !ok) return ok;
    if (auto ok = check_frame(robot.name, robot.poses); !ok) return prefixed("pose: ", ok.error());
    if (scan.begins_map && robot.last_seq == 0) { // later scans are placed relative to the first
        const auto shows = [](const Member& other) { return other.first_visible_seq > 0; };
        if (is_mapped || std::ranges::any_of(members_, shows)) return map_already_begun(robot.name, info_.name);
    }
    return wire::check_scan(scan, *known->sensor);
}

PendingEntry RobotSequencer::announce(const MapsCorrected& corrected) {
    pending_.apply(corrected);
    return {PendingEntry::kNoRobot, corrected, {}, 0};
}

Result<PendingEntry> RobotSequencer::relocalize(const RobotRelocalized& relocalized) {
    const auto& robots = pending_.robots();
    if (relocalized.robot >= robots.size()) return Error{Errc::kNotFound, "the robot has not joined"};
    const auto& robot = robots[relocalized.robot];
    if (robot.poses == Poses::kMap) {
        return Error{
            Errc::kConflict,
            fmt::format("robot '{}' sends its poses (--poses map), so the server does not locate it", robot.name)};
    }
    pending_.apply(relocalized);
    return PendingEntry{PendingEntry::kNoRobot, relocalized, {}, 0};
}

Result<std::optional<PendingEntry>> RobotSequencer::change_mode(const ModeChanged& changed) {
    if (changed.is_localize_only == pending_.is_localize_only()) return std::nullopt;
    const auto* sender = pending_.find_sender();
    if (!changed.is_localize_only && pending_.frame_origin() == FrameOrigin::kEstimated && sender != nullptr) {
        return Error{Errc::kConflict,
                     fmt::format("localize_only: the session has robot '{}', which sends its poses (--poses map), and "
                                 "robot '{}', whose estimated poses began the map; they cannot both change it, so it "
                                 "stays as it is",
                                 sender->name, pending_.find_estimated()->name)};
    }
    pending_.apply(changed);
    return PendingEntry{PendingEntry::kNoRobot, changed, {}, 0};
}

// Acknowledgements

void RobotSequencer::release(const Group& group) {
    std::map<RobotIndex, std::size_t> bytes; // one message per robot
    for (const auto& released : group.entries) {
        if (released.robot == PendingEntry::kNoRobot) continue;
        Member& member = members_[released.robot];
        bytes[released.robot] += released.bytes;
        --member.pending_entries;
        if (!released.entry) continue;
        if (const auto* taken = std::get_if<ScanTaken>(&*released.entry)) member.durable_seq = taken->scan.seq;
    }
    for (const auto& [robot, released] : bytes) {
        Member& member = members_[robot];
        if (member.listener) member.listener->on_durable(member.durable_seq, released);
        admit(member);
    }
}

} // namespace scanloom::sessions
