#include "robot_client/ros/live_scans.hpp"

#include "common/error/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

namespace scanloom::robot {
namespace {

constexpr RosTime kTransformsKept = 60'000'000'000; // ns; a simulation may be faster than the clock
constexpr std::size_t kTreePrunedFrom = 100'000;    // transforms
constexpr std::size_t kLaserFramesMax = 1'000;
constexpr auto kSurveyRepeated = std::chrono::milliseconds(500);

} // namespace

LiveScans::LiveScans(LiveScanOptions options) : options_(std::move(options)), survey_(kTransformsKept) {}

bool LiveScans::needs(const RecordedTopic& topic) const {
    if (topic.encoding == MessageEncoding::kOther) return false;
    if (has_transforms(topic)) return true;
    if (topic.type == kOdometryType) {
        if (!choice_) return options_.robot.odom_topic.empty() || topic.name == options_.robot.odom_topic;
        return choice_->frames.odom_topic && topics_.all()[*choice_->frames.odom_topic] == topic;
    }
    if (!may_be_used(topic)) return false;
    if (!choice_) return true;
    return std::ranges::any_of(choice_->lasers, [&](const FoundLaser& laser) {
        return laser.left_out.empty() && topics_.all()[laser.topic] == topic;
    });
}

/// Returns whether a topic is of a laser that the options do not leave out.
bool LiveScans::may_be_used(const RecordedTopic& topic) const {
    const auto& stated = options_.robot.topics;
    return is_laser(topic) && (stated.empty() || std::ranges::find(stated, topic.name) != stated.end());
}

bool LiveScans::is_late_laser(const RecordedTopic& topic) const {
    return choice_ && may_be_used(topic) && std::ranges::find(topics_.all(), topic) == topics_.all().end();
}

std::optional<RosTime> LiveScans::add(const RecordedTopic& topic, RosTime received, std::string_view bytes, Time now) {
    const auto index = topics_.add(topic);
    if (!index) return std::nullopt;
    const RecordedMessage message{*index, received, bytes};
    // too many transforms cannot be an error here, because old ones are forgotten
    if (!choice_) static_cast<void>(survey_.add(topics_.all(), message));
    if (is_laser(topic)) return add_scan(*index, message, now);
    if (choice_) add_transforms(topic, message);
    return std::nullopt;
}

std::optional<RosTime> LiveScans::add_scan(std::size_t topic, const RecordedMessage& message, Time now) {
    const RecordedTopic& described = topics_.all()[topic];
    auto scan = decode_laser_scan(message.bytes, described.encoding, described.type);
    if (!scan) {
        ++skipped_["malformed messages"];
        return std::nullopt;
    }
    Laser& laser = lasers_[topic];
    if (laser_frames_.size() < kLaserFramesMax) laser_frames_.insert(scan->header.frame);
    if (!choice_ && !survey_end_ && missing_topics().empty()) {
        survey_end_ = now + options_.survey;
        survey_end_max_ = now + std::max(options_.survey, options_.survey_max);
    }
    if (choice_) laser.habits.add(*scan);
    const RosTime stamp = scan->header.stamp != 0 ? scan->header.stamp : message.time;
    if (const auto missing = laser.gaps.add(stamp); missing > 0) note_gap(described.name, missing);
    if (const auto usable = check_usable(*scan); !usable) {
        ++skipped_[usable.error().message];
        return stamp;
    }
    waiting_.push_back({std::move(*scan), message.time, topic, now + options_.transform_wait});
    if (waiting_.size() > kWaitingMax) {
        waiting_.pop_front();
        ++skipped_["too many were waiting"];
    }
    return stamp;
}

void LiveScans::note_gap(const std::string& topic, std::uint64_t missing) {
    if (std::exchange(is_gap_noted_, true)) return;
    notes_.push_back(fmt::format("{}: about {} scans are missing between two stamps: the bridge or the driver drops "
                                 "messages; run this program on the robot itself",
                                 topic, missing));
}

void LiveScans::add_transforms(const RecordedTopic& topic, const RecordedMessage& message) {
    const bool is_odometry = choice_->frames.odom_topic == message.topic;
    if (is_odometry) {
        auto odometry = odometry_of(message, topic.encoding);
        if (!odometry) return;
        odometry->child = choice_->frames.odom_child;
        tree_.add(*odometry, false);
        return;
    }
    if (!has_transforms(topic) || choice_->frames.unused_tf.contains(namespace_of(topic.name))) return;
    std::size_t unusable = 0;
    const auto transforms = decode_transforms(message.bytes, topic.encoding, unusable);
    if (!transforms) return;
    for (const auto& one : *transforms) {
        if (one.child != choice_->frames.odom_child) tree_.add(one, has_static_transforms(topic));
    }
    prune_tree();
}

/// Removes the transforms of joints and other things that no laser is mounted on.
void LiveScans::prune_tree() {
    if (tree_.size() < std::max(pruned_at_, kTreePrunedFrom)) return;
    std::set<std::string> needed = laser_frames_;
    needed.insert(choice_->frames.base);
    tree_.keep_ancestors(needed);
    pruned_at_ = 2 * tree_.size();
}

void LiveScans::resume(Time now) {
    is_interrupted_ = false;
    for (auto& [topic, laser] : lasers_) laser.gaps.restart();
    for (auto& waiting : waiting_) waiting.until = now + options_.transform_wait;
}

std::vector<std::string> LiveScans::missing_topics() const {
    std::set<std::string> named(options_.robot.topics.begin(), options_.robot.topics.end());
    for (const auto& mount : options_.robot.mounts) {
        if (!mount.topic.empty()) named.insert(mount.topic);
    }
    for (const auto& [topic, laser] : lasers_) named.erase(topics_.all()[topic].name);
    return {named.begin(), named.end()};
}

/// Returns whether poses, the mount of a laser, or something that the options name has not come so far.
bool LiveScans::lacks_something(const Result<LaserChoice>& choice) const {
    if (!choice) return choice.error().code == Errc::kNotFound;
    if (choice->frames.poses == Poses::kNone && options_.robot.poses != Poses::kNone) return true;
    return std::ranges::any_of(choice->lasers, [](const FoundLaser& laser) {
        return laser.left_out == kMountUnknown || (laser.left_out.empty() && !laser.is_connected && !laser.mount);
    });
}

Result<bool> LiveScans::choose(Time now) {
    auto found = Surveyor(survey_).finish(topics_.all());
    found.origin = "bridge";
    auto choice = choose_lasers(found, options_.robot);
    if (now < survey_end_max_ && lacks_something(choice)) {
        survey_end_ = std::min(now + kSurveyRepeated, survey_end_max_);
        return false;
    }
    if (!choice) return choice.error();
    for (const auto& laser : choice->lasers) {
        lasers_[laser.topic].habits = std::move(found.lasers.at(laser.topic).habits);
    }
    for (const auto& note : choice->notes) notes_.push_back(note);
    choice_ = std::move(*choice);
    tree_ = std::move(found.tree);
    tree_.forget_before_newest(kTransformsKept);
    return true;
}

std::string LiveScans::odom_topic() const {
    const auto& topic = choice_->frames.odom_topic;
    return topic ? topics_.all()[*topic].name : std::string();
}

const FoundLaser* LiveScans::found_laser(std::size_t topic) const {
    const auto laser = std::ranges::find(choice_->lasers, topic, &FoundLaser::topic);
    return laser == choice_->lasers.end() ? nullptr : &*laser;
}

std::optional<Observation> LiveScans::take(Time now) {
    while (choice_ && !waiting_.empty()) {
        const Waiting& next = waiting_.front();
        const FoundLaser* laser = found_laser(next.topic);
        std::string reason(laser == nullptr ? "of a topic that appeared later" : laser->left_out);
        if (reason.empty()) {
            const auto found = place_of_scan(tree_, choice_->frames, *laser, next.scan.header.frame,
                                             middle_of(next.scan, next.received));
            if (const auto* place = std::get_if<ScanPlace>(&found)) {
                auto observation = observer_.observe(
                    next.scan, next.received, laser->id, topics_.all()[next.topic].name,
                    lasers_.at(next.topic).habits.meaning(options_.robot.ranges), *place, choice_->frames.poses);
                waiting_.pop_front();
                ++taken_;
                return observation;
            }
            const auto& none = std::get<NoPlace>(found);
            const bool waits = (is_interrupted_ && now != Time::max()) || now < next.until;
            if (none.may_come && waits) return std::nullopt;
            reason = none.reason;
        }
        ++skipped_[reason];
        waiting_.pop_front();
    }
    return std::nullopt;
}

std::optional<LiveScans::Time> LiveScans::next_deadline() const {
    return choice_ && !waiting_.empty() && !is_interrupted_ ? std::optional(waiting_.front().until) : std::nullopt;
}

std::uint64_t LiveScans::gaps() const {
    std::uint64_t gaps = 0;
    for (const auto& [topic, laser] : lasers_) gaps += laser.gaps.gaps();
    return gaps;
}

std::uint64_t LiveScans::missing() const {
    std::uint64_t missing = 0;
    for (const auto& [topic, laser] : lasers_) missing += laser.gaps.missing();
    return missing;
}

} // namespace scanloom::robot
