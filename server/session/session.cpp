#include "server/session/session.hpp"

#include "common/wire/log_codec.hpp"
#include "common/wire/messages.hpp"
#include "server/session/checkpoint.hpp"

#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

namespace scanloom::session {
namespace {

constexpr std::size_t kGroupEntriesMax = 256; // entries appended at once: bounds the wait for an ack
constexpr Revision kCheckpointEvery = 4096;   // entries folded between two checkpoints
constexpr std::size_t kRobotsMax = 1024;      // of one session

} // namespace

Session::Session(SessionInfo info, mapping::Projection projection, Revision checkpointed, store::ScanLog& log,
                 boost::asio::any_io_executor compute, std::shared_ptr<SessionCounters> counters)
    : info_(std::move(info)), log_(log), counters_(std::move(counters)), strand_(std::move(compute)),
      projection_(std::move(projection)), appended_(projection_.revision()), checkpointed_(checkpointed) {
    forget_what_is_not_durable();
    publish();
}

std::shared_ptr<const mapping::Snapshot> Session::snapshot() const {
    const std::lock_guard lock(published_mutex_);
    return published_;
}

bool Session::is_connected(RobotIndex robot) const {
    const std::lock_guard lock(published_mutex_);
    return robot < connected_.size() && connected_[robot];
}

template <class Work>
void Session::on_strand(Work work) {
    boost::asio::post(strand_, [self = shared_from_this(), work = std::move(work)]() mutable { work(*self); });
}

// Joining and leaving

void Session::join(std::string robot, std::shared_ptr<RobotListener> listener,
                   std::function<void(Result<Joined>)> done) {
    on_strand([robot = std::move(robot), joining = Joining{std::move(listener), std::move(done)}](
                  Session& self) mutable { self.do_join(robot, std::move(joining)); });
}

void Session::do_join(const std::string& robot, Joining joining) {
    if (refusing_) return joining.done(*refusing_);
    auto member = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.name == robot; });
    const auto index = static_cast<RobotIndex>(member - members_.begin());
    if (member == members_.end()) {
        if (members_.size() >= kRobotsMax) {
            return joining.done(Error{
                Errc::kTooLarge, fmt::format("session '{}' has {} robots already, the most it can hold; use another "
                                             "session",
                                             info_.name, members_.size())});
        }
        members_.emplace_back().name = robot;
        enqueue({index, {RobotJoined{index, robot}}, 0});
    } else {
        fail(*member, {Errc::kReplaced, fmt::format("robot '{}' of session '{}' connected again; this link is closed",
                                                    robot, info_.name)});
    }
    members_[index].joining = std::move(joining);
    admit(index);
}

/// Lets the link in that waits to become the robot's, once nothing of the earlier ones is under way.
void Session::admit(RobotIndex robot) {
    auto& member = members_[robot];
    if (!member.joining || member.under_way > 0) return;
    const auto joining = *std::exchange(member.joining, std::nullopt);
    member.listener = joining.listener;
    set_connected(robot, true);
    joining.done(Joined{robot, member.durable_seq});
}

void Session::leave(std::shared_ptr<RobotListener> listener) {
    on_strand([listener = std::move(listener)](Session& self) {
        Member* member = self.member_of(listener);
        if (member == nullptr) return;
        member->listener.reset();
        self.set_connected(static_cast<RobotIndex>(member - self.members_.data()), false);
    });
}

Session::Member* Session::member_of(const std::shared_ptr<RobotListener>& listener) {
    const auto member =
        std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.listener == listener; });
    return member == members_.end() ? nullptr : &*member;
}

void Session::set_connected(RobotIndex robot, bool connected) {
    const std::lock_guard lock(published_mutex_);
    connected_.resize(std::max<std::size_t>(connected_.size(), members_.size()));
    connected_[robot] = connected;
}

// Down: from a link to the log

void Session::submit(std::shared_ptr<RobotListener> from, Sensor sensor, std::size_t bytes) {
    on_strand([from = std::move(from), sensor = std::move(sensor), bytes](Session& self) mutable {
        Member* member = self.member_of(from);
        if (member != nullptr && !self.refusing_) self.describe(*member, std::move(sensor), bytes);
    });
}

void Session::submit(std::shared_ptr<RobotListener> from, std::vector<Scan> scans, std::size_t bytes) {
    on_strand([from = std::move(from), scans = std::move(scans), bytes](Session& self) mutable {
        Member* member = self.member_of(from);
        if (member != nullptr && !self.refusing_) self.take(*member, std::move(scans), bytes);
    });
}

void Session::describe(Member& member, Sensor sensor, std::size_t bytes) {
    if (auto ok = mapping::check_reach(info_.config, sensor); !ok) {
        return fail(member, prefixed("sensor_description.", ok.error()));
    }
    const auto robot = static_cast<RobotIndex>(&member - members_.data());
    Submission submission{robot, {}, bytes};
    const auto known = member.sensors.find(sensor.id);
    if (known == member.sensors.end() || known->second != sensor) {
        member.sensors[sensor.id] = sensor;
        submission.entries.push_back(SensorDescribed{robot, std::move(sensor)});
    }
    enqueue(std::move(submission));
}

void Session::take(Member& member, std::vector<Scan> scans, std::size_t bytes) {
    Submission submission{static_cast<RobotIndex>(&member - members_.data()), {}, bytes};
    for (std::size_t n = 0; n < scans.size(); ++n) {
        Scan& scan = scans[n];
        if (scan.seq <= member.received_seq) { // sent again after a reconnect: the log has it
            ++counters_->scans_duplicates;
            continue;
        }
        if (auto ok = check_next(member, scan); !ok) {
            enqueue(std::move(submission)); // the scans before it have been received and count as such
            return fail(member, prefixed(fmt::format("scan_batch.scans[{}].", n), ok.error()));
        }
        member.received_seq = scan.seq;
        submission.entries.push_back(ScanTaken{submission.robot, std::move(scan)});
    }
    enqueue(std::move(submission));
}

Result<> Session::check_next(const Member& member, const Scan& scan) const {
    if (projection_.is_full()) {
        return Error{Errc::kTooLarge,
                     fmt::format("pose leads on in a map that is full with {} chunks of 64 x 64 cells; "
                                 "use larger cells or another session",
                                 mapping::kChunksMax)};
    }
    if (scan.seq != member.received_seq + 1) {
        return Error{
            Errc::kOutOfOrder,
            fmt::format("seq is {}, {} is the next of robot '{}'; connect again and continue after last_durable_seq",
                        scan.seq, member.received_seq + 1, member.name)};
    }
    const auto sensor = member.sensors.find(scan.sensor);
    if (sensor == member.sensors.end()) {
        return Error{Errc::kInvalidField,
                     fmt::format("sensor is {}, which was not described; send a SensorDescription first", scan.sensor)};
    }
    return wire::check_scan(scan, sensor->second);
}

void Session::enqueue(Submission submission) {
    ++members_[submission.robot].under_way;
    waiting_.push_back(std::move(submission));
    append_next();
}

/// Hands what waits to the log, one group at a time: the next begins when the last is durable.
void Session::append_next() {
    if (appending_) return;
    Group group;
    std::vector<std::string> entries;
    while (!waiting_.empty() && entries.size() < kGroupEntriesMax) {
        for (const auto& entry : waiting_.front().entries) entries.push_back(wire::encode_entry(entry));
        group.push_back(std::move(waiting_.front()));
        waiting_.pop_front();
    }
    if (entries.empty()) return release(group);
    appending_ = true;
    const Revision first = appended_ + 1;
    appended_ += entries.size();
    log_.append(info_.id, first, std::move(entries),
                [self = shared_from_this(), group = std::move(group)](const Result<>& appended) mutable {
                    self->on_strand([group = std::move(group), appended](Session& session) mutable {
                        session.on_appended(std::move(group), appended);
                    });
                });
}

// Up: from the log to the maps, and to the links

void Session::on_appended(Group group, const Result<>& appended) {
    appending_ = false;
    if (!appended) return stop_writing(appended.error());
    if (broken_) return finish_closing();
    append_next(); // the disk works while this group is folded
    if (auto folded = fold_guarded(group); !folded) return stop_writing(folded.error());
    publish();
    release(group);
    if (projection_.revision() - checkpointed_ >= kCheckpointEvery) write_checkpoint();
    finish_closing();
}

/// Fails only by a mistake of ours: take() and describe() let only entries through that can follow.
Result<> Session::fold(const Group& group) {
    for (const auto& submission : group) {
        for (const auto& entry : submission.entries) {
            if (auto folded = projection_.fold(entry); !folded) return folded.error();
            if (const auto* taken = std::get_if<ScanTaken>(&entry)) {
                members_[submission.robot].durable_seq = taken->scan.seq;
                ++counters_->scans_applied;
            }
        }
    }
    return {};
}

/// Memory may run out for one session; that must not end the others.
Result<> Session::fold_guarded(const Group& group) {
    try {
        return fold(group);
    } catch (const std::bad_alloc&) {
        return Error{Errc::kTooLarge, "there is no memory left for this map; use larger cells or another session"};
    }
}

void Session::publish() {
    auto snapshot = std::make_shared<const mapping::Snapshot>(projection_.snapshot());
    const std::lock_guard lock(published_mutex_);
    published_.swap(snapshot);
}

/// Gives back the credit of a group: one message a robot.
void Session::release(const Group& group) {
    std::map<RobotIndex, std::size_t> bytes;
    for (const auto& submission : group) {
        bytes[submission.robot] += submission.bytes;
        --members_[submission.robot].under_way;
    }
    for (const auto& [robot, released] : bytes) {
        const auto& member = members_[robot];
        if (member.listener) member.listener->on_durable(member.durable_seq, released);
        admit(robot);
    }
}

// When things go wrong, and the end

void Session::fail(Member& member, const Error& error) {
    if (const auto joining = std::exchange(member.joining, std::nullopt)) joining->done(error);
    if (!member.listener) return;
    const auto listener = std::move(member.listener);
    member.listener.reset();
    set_connected(static_cast<RobotIndex>(&member - members_.data()), false);
    listener->on_failed(error);
}

void Session::fail_all(const Error& error) {
    for (auto& member : members_) fail(member, error);
}

/// The log could not be written. What the disk holds is unknown until the store is opened again, so
/// nothing more is written; the maps stay readable as they are.
void Session::stop_writing(const Error& error) {
    spdlog::error("session '{}': {}", info_.name, error.message);
    refusing_ = error;
    broken_ = true;
    waiting_.clear();
    fail_all(error);
    forget_what_is_not_durable();
    finish_closing();
}

void Session::forget_what_is_not_durable() {
    const auto state = projection_.state();
    members_.resize(state.robots.size());
    for (std::size_t n = 0; n < members_.size(); ++n) {
        auto& member = members_[n];
        member.name = state.robots[n].name;
        member.received_seq = member.durable_seq = state.robots[n].last_seq;
        member.under_way = 0;
        member.sensors.clear();
        for (const auto& sensor : state.robots[n].sensors) member.sensors[sensor.id] = sensor;
    }
}

void Session::write_checkpoint() {
    if (checkpointing_) return;
    checkpointing_ = true;
    auto write = [self = shared_from_this(), snapshot = snapshot(), state = projection_.state(),
                  since = checkpointed_] {
        const auto written = self->log_.write_checkpoint(self->info_.id, checkpoint_parts(*snapshot, state, since));
        if (!written) spdlog::warn("session '{}': no checkpoint: {}", self->info_.name, written.error().message);
        self->on_strand([revision = written ? state.revision : since](Session& session) {
            session.checkpointed_ = revision;
            session.checkpointing_ = false;
            session.finish_closing();
        });
    };
    boost::asio::post(strand_.get_inner_executor(), std::move(write)); // beside the strand: folding goes on
}

void Session::close(Error reason, std::function<void()> done) {
    on_strand([reason = std::move(reason), done = std::move(done)](Session& self) mutable {
        if (!self.refusing_) self.refusing_ = std::move(reason);
        self.closed_ = std::move(done);
        self.finish_closing();
    });
}

/// Goes on with closing as far as possible: called whenever something it waits for has happened.
void Session::finish_closing() {
    if (!closed_ || appending_ || !waiting_.empty() || checkpointing_) return;
    fail_all(*refusing_);
    if (projection_.revision() > checkpointed_ && !broken_ && !final_checkpoint_tried_) {
        final_checkpoint_tried_ = true;
        return write_checkpoint();
    }
    const auto closed = std::move(closed_);
    closed_ = nullptr;
    closed();
}

} // namespace scanloom::session
