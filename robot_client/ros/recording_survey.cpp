#include "robot_client/ros/recording_survey.hpp"

#include "robot_client/ros/frame_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::size_t kPruneFrom = 100'000;         // transforms
constexpr std::string_view kNamelessRobot = "base"; // the child frame of odometry that names none

/// Returns the index of a text in a list, to which it is added if it is new.
std::uint32_t index_in(std::vector<std::string>& texts, const std::string& text) {
    const auto index = static_cast<std::uint32_t>(std::ranges::find(texts, text) - texts.begin());
    if (index == texts.size()) texts.push_back(text);
    return index;
}

} // namespace

void Surveyor::add_topics(const std::vector<RecordedTopic>& topics) {
    while (found_.topics.size() < topics.size()) {
        auto& topic = found_.topics.emplace_back();
        static_cast<RecordedTopic&>(topic) = topics[found_.topics.size() - 1];
    }
}

Result<> Surveyor::add(const std::vector<RecordedTopic>& topics, const RecordedMessage& message) {
    add_topics(topics);
    auto& topic = found_.topics[message.topic];
    if (topic.messages++ == 0) topic.first = message.time;
    topic.first = std::min(topic.first, message.time);
    topic.last = std::max(topic.last, message.time);
    if (is_laser(topic)) add_laser(topic, message);
    if (topic.type == kOdometryType) add_odometry(topic, message);
    if (has_transforms(topic)) add_transforms(topic, message);
    if (found_.scans.size() >= std::numeric_limits<std::uint32_t>::max() - 1) {
        return Error{Errc::kTooLarge, "more than 2^32 - 2 scans; split the recording"};
    }
    return limit_transforms();
}

void Surveyor::add_laser(SurveyedTopic& topic, const RecordedMessage& message) {
    const auto scan = decode_laser_scan(message.bytes, topic.encoding, topic.type);
    SurveyedScan one;
    one.topic = static_cast<std::uint32_t>(message.topic);
    const auto usable = scan ? check_usable(*scan) : Result<>(scan.error());
    if (!scan) ++topic.malformed;
    if (!usable) one.problem = index_in(found_.problems, scan ? usable.error().message : "malformed messages");
    if (scan) {
        ++topic.frames[scan->header.frame];
        one.frame = index_in(found_.frames, scan->header.frame);
        one.middle = middle_of(*scan, message.time);
        one.epoch = epoch_of(message, {}, one.middle);
        auto& laser = found_.lasers[message.topic];
        laser.habits.add(*scan);
        const std::array<float, 4> fields{scan->angle_min, scan->angle_increment, scan->range_min, scan->range_max};
        const auto add = [&](const auto& values) {
            laser.hash.update({reinterpret_cast<const char*>(std::data(values)), std::size(values) * sizeof(float)});
        };
        add(fields);
        add(scan->ranges);
    }
    found_.scans.push_back(one);
}

void Surveyor::add_odometry(SurveyedTopic& topic, const RecordedMessage& message) {
    const auto odometry = odometry_of(message, topic.encoding);
    if (!odometry) {
        ++topic.malformed;
        return;
    }
    ++topic.frames[odometry->header.frame];
    found_.odom_child.emplace(message.topic, odometry->child);
    auto& tree = found_.odometry[message.topic];
    if (kept_) tree.forget_before_newest(*kept_);
    tree.add(*odometry, false, epoch_of(message, {}, odometry->header.stamp));
}

void Surveyor::add_transforms(SurveyedTopic& topic, const RecordedMessage& message) {
    const auto transforms = decode_transforms(message.bytes, topic.encoding, found_.unusable_transforms);
    if (!transforms) {
        ++topic.malformed;
        return;
    }
    const bool is_static = has_static_transforms(topic);
    FrameTree& tree = found_.trees[namespace_of(topic.name)];
    if (kept_) tree.forget_before_newest(*kept_);
    for (const auto& one : *transforms) {
        tree.add(one, is_static, is_static ? 0 : epoch_of(message, one.child, one.header.stamp));
    }
}

/// Removes the transforms of joints and other things that no laser is mounted on.
Result<> Surveyor::limit_transforms() {
    std::size_t odometry_count = 0;
    for (const auto& [topic, odometry] : found_.odometry) odometry_count += odometry.size();
    const auto count_all = [&] {
        std::size_t count = odometry_count;
        for (const auto& [name, tree] : found_.trees) count += tree.size();
        return count;
    };
    std::size_t count = count_all();
    if (count < std::max(pruned_at_, kPruneFrom)) return {};
    if (!found_.frames.empty()) {
        std::set<std::string> needed{found_.frames.begin(), found_.frames.end()};
        for (const auto& [topic, child] : found_.odom_child) needed.insert(child);
        for (auto& [name, tree] : found_.trees) {
            auto needed_here = needed;
            needed_here.merge(tree.children_of(is_fixed_name)); // of a laser that no transform leads to
            tree.keep_ancestors(needed_here);
        }
        count = count_all();
    }
    pruned_at_ = 2 * count;
    if (count <= kTransformsMax) return {};
    return Error{
        Errc::kTooLarge,
        fmt::format("more than {} transforms between lasers and fixed frames; split the recording", kTransformsMax)};
}

RecordingSurvey Surveyor::finish(const std::vector<RecordedTopic>& topics) && {
    add_topics(topics);
    return std::move(found_);
}

std::vector<std::string> texts_of(const RecordingLosses& losses) {
    constexpr std::size_t kShown = 3;
    std::vector<std::string> texts;
    for (std::size_t n = 0; n < std::min(losses.first.size(), kShown); ++n) {
        texts.push_back(fmt::format("lost at byte {}: {}", losses.first[n].offset, losses.first[n].reason));
    }
    if (losses.count > kShown) texts.push_back(fmt::format("lost: {} more parts", losses.count - kShown));
    return texts;
}

bool has_transforms(const RecordedTopic& topic) {
    return topic.type == kTransformsType || topic.type == kOldTransformsType;
}

std::string namespace_of(std::string_view topic) {
    const auto slash = topic.rfind('/');
    return std::string(topic.substr(0, slash == std::string_view::npos ? 0 : slash));
}

std::size_t common_namespace(std::string_view a, std::string_view b) {
    const auto differ = std::ranges::mismatch(a, b).in1 - a.begin();
    return a.substr(0, static_cast<std::size_t>(differ)).rfind('/') + 1; // 0 if there is none
}

bool has_static_transforms(const RecordedTopic& topic) {
    return has_transforms(topic) && topic.name.ends_with("tf_static");
}

Result<RosTransform> odometry_of(const RecordedMessage& message, MessageEncoding encoding) {
    auto odometry = decode_odometry(message.bytes, encoding);
    if (!odometry) return odometry;
    const auto& frame = odometry->header.frame;
    auto& child = odometry->child;
    if (child.empty() || child == frame) child = frame == kNamelessRobot ? "robot" : kNamelessRobot;
    if (odometry->header.stamp == 0) odometry->header.stamp = message.time;
    return odometry;
}

bool is_laser(const RecordedTopic& topic) {
    return topic.encoding != MessageEncoding::kOther && (topic.type == kLaserScanType || topic.type == kMultiEchoType);
}

Result<RecordingSurvey> survey(const std::filesystem::path& path, const OnRead& on_read) {
    auto recording = open_recording(path);
    if (!recording) return recording.error();
    Surveyor surveyor;
    for (;;) {
        const auto message = (*recording)->next();
        if (!message) return message.error();
        const auto& topics = (*recording)->topics();
        if (!*message) {
            auto found = std::move(surveyor).finish(topics);
            found.losses = {(*recording)->losses_count(), (*recording)->losses()};
            return found;
        }
        if (auto added = surveyor.add(topics, **message); !added) return added.error();
        if (on_read) on_read((*recording)->progress());
    }
}

} // namespace scanloom::robot
