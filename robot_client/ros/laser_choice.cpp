#include "robot_client/ros/laser_choice.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace scanloom::robot {
namespace {

/// Returns the name of the frame that most scans of a topic have.
const std::string& frame_of(const SurveyedTopic& topic) {
    return std::ranges::max_element(topic.frames, {}, [](const auto& frame) { return frame.second; })->first;
}

/// Makes the choice, step by step.
class LaserChooser {
public:
    LaserChooser(RecordingSurvey& found, const RecordingOptions& options) : found_(found), options_(options) {}

    [[nodiscard]] Result<LaserChoice> make();

private:
    [[nodiscard]] Result<> list_lasers();
    [[nodiscard]] Result<> check_topic(std::string_view option, const std::string& topic) const;
    [[nodiscard]] Result<> assign_mounts();
    [[nodiscard]] const std::string& leading_frame() const;
    void leave_out_lasers();

    [[nodiscard]] const std::string& name_of(const FoundLaser& laser) const { return found_.topics[laser.topic].name; }

    RecordingSurvey& found_;
    const RecordingOptions& options_;
    LaserChoice choice_;
};

Result<> LaserChooser::check_topic(std::string_view option, const std::string& topic) const {
    std::vector<std::string> names;
    for (const auto& laser : choice_.lasers) names.push_back(name_of(laser));
    if (std::ranges::find(names, topic) != names.end()) return {};
    return Error{Errc::kNotFound, fmt::format("{} {}: the {} has no scans of this topic; it has: {}", option, topic,
                                              found_.origin, fmt::join(names, ", "))};
}

/// Lists the lasers, without those that the options leave out and those that repeat the scans of another one.
Result<> LaserChooser::list_lasers() {
    for (const auto& [topic, laser] : found_.lasers) choice_.lasers.push_back({topic, {}});
    if (choice_.lasers.empty()) {
        return Error{Errc::kNotFound,
                     fmt::format("the {} has no scans that can be read: no sensor_msgs/LaserScan or MultiEchoLaserScan",
                                 found_.origin)};
    }
    std::ranges::stable_sort(choice_.lasers, std::greater<>(),
                             [&](const FoundLaser& laser) { return found_.topics[laser.topic].messages; });
    for (const auto& topic : options_.topics) {
        if (auto checked = check_topic("--topic", topic); !checked) return checked;
    }
    std::set<std::string> frames;
    for (auto& laser : choice_.lasers) {
        const bool is_chosen = std::ranges::find(options_.topics, name_of(laser)) != options_.topics.end();
        if (!options_.topics.empty() && !is_chosen) laser.left_out = "not a --topic";
        const bool is_new = laser.left_out.empty() && frames.insert(frame_of(found_.topics[laser.topic])).second;
        if (laser.left_out.empty() && !is_new && !is_chosen) laser.left_out = "in the frame of another topic";
    }
    return {};
}

Result<> LaserChooser::assign_mounts() {
    for (const auto& stated : options_.mounts) {
        if (stated.topic.empty()) {
            const auto count = std::ranges::count(choice_.lasers, std::string_view(), &FoundLaser::left_out);
            if (count > 1) {
                return Error{Errc::kInvalidField,
                             fmt::format("--mount: the {} has {} lasers; say whose mount it is: --mount {}=X,Y,YAW, or "
                                         "choose one with --topic",
                                         found_.origin, count, name_of(choice_.lasers.front()))};
            }
        } else if (auto checked = check_topic("--mount", stated.topic); !checked) {
            return checked;
        }
        for (auto& laser : choice_.lasers) {
            const bool is_its = stated.topic.empty() ? laser.left_out.empty() : stated.topic == name_of(laser);
            if (is_its) laser.mount = stated.T_robot_laser;
        }
    }
    return {};
}

/// Returns the frame of the laser whose transforms tell the robot's frame: of the one with most scans among those that
/// transforms lead to, or else of the one with most scans.
const std::string& LaserChooser::leading_frame() const {
    const auto frame = [&](const FoundLaser& laser) -> const std::string& {
        return frame_of(found_.topics[laser.topic]);
    };
    const auto is_used = [](const FoundLaser& laser) { return laser.left_out.empty(); };
    const auto leading = std::ranges::find_if(choice_.lasers, [&](const FoundLaser& laser) {
        return is_used(laser) && found_.tree.ancestors(frame(laser)).size() > 1;
    });
    return frame(leading != choice_.lasers.end() ? *leading : *std::ranges::find_if(choice_.lasers, is_used));
}

/// Chooses the lasers whose mounts are known, or else the one with most scans.
void LaserChooser::leave_out_lasers() {
    for (auto& laser : choice_.lasers) {
        const auto chain = found_.tree.ancestors(frame_of(found_.topics[laser.topic]));
        laser.is_connected = std::ranges::find(chain, choice_.frames.base) != chain.end();
    }
    const auto is_used = [](const FoundLaser& laser) { return laser.left_out.empty(); };
    const auto has_mount = [](const FoundLaser& laser) { return laser.is_connected || laser.mount; };
    const bool has_known = std::ranges::any_of(
        choice_.lasers, [&](const FoundLaser& laser) { return is_used(laser) && has_mount(laser); });
    const auto richest = std::ranges::find_if(choice_.lasers, is_used);
    std::uint32_t id = 0;
    for (auto& laser : choice_.lasers) {
        if (!is_used(laser)) continue;
        const bool is_chosen = has_known ? has_mount(laser) : &laser == &*richest;
        if (!is_chosen || id == kSensorsMax) laser.left_out = kMountUnknown;
        if (!is_used(laser)) continue;
        laser.id = id++;
        if (laser.mount && laser.is_connected) {
            choice_.notes.push_back(fmt::format("{}: --mount replaces the mount of the transforms", name_of(laser)));
        }
    }
    if (!has_known && choice_.frames.poses != Poses::kNone) {
        choice_.notes.push_back(
            fmt::format("{}: its mount on the robot is not known, and taken as 0,0,0; state it with --mount {}=X,Y,YAW",
                        name_of(*richest), name_of(*richest)));
    }
    for (const auto& laser : choice_.lasers) {
        if (laser.left_out != kMountUnknown) continue;
        choice_.notes.push_back(
            fmt::format("{}: its {} scans are left out, because no transform leads from the robot's "
                        "frame {} to it; state its mount with --mount {}=X,Y,YAW",
                        name_of(laser), found_.topics[laser.topic].messages, choice_.frames.base, name_of(laser)));
    }
}

Result<LaserChoice> LaserChooser::make() {
    if (auto listed = list_lasers(); !listed) return listed.error();
    if (auto assigned = assign_mounts(); !assigned) return assigned.error();
    auto frames = choose_frames(found_, options_, leading_frame());
    if (!frames) return frames.error();
    choice_.frames = std::move(*frames);
    leave_out_lasers();
    return std::move(choice_);
}

} // namespace

Result<LaserChoice> choose_lasers(RecordingSurvey& found, const RecordingOptions& options) {
    return LaserChooser(found, options).make();
}

} // namespace scanloom::robot
