#include "robot_client/ros/laser_choice.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/ros/frame_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::string_view kOtherRobot = "of another robot"; // see FoundLaser::left_out

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
    [[nodiscard]] Result<std::set<std::string>> join_trees();
    void leave_out_other_robots(const std::set<std::string>& unused_tf);
    [[nodiscard]] std::set<std::string> namespaces_apart_from(const std::string& topic) const;
    [[nodiscard]] LeadingLaser leading_laser() const;
    [[nodiscard]] bool has_other_odometry(const std::string& topic) const;
    [[nodiscard]] std::string text_of_unknown_mount(const FoundLaser& laser) const;
    void note_unnamed_poses(const std::string& laser_frame);
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

/// Returns the namespaces of transforms that a topic is not in.
std::set<std::string> LaserChooser::namespaces_apart_from(const std::string& topic) const {
    std::set<std::string> apart;
    for (const auto& [name, tree] : found_.trees) {
        if (!topic.starts_with(name + "/") && !name.empty()) apart.insert(name);
    }
    return apart;
}

/// Joins the transforms of the namespaces around the topic of the laser with most scans; if there are none, of all.
/// @return the namespaces that are left out
Result<std::set<std::string>> LaserChooser::join_trees() {
    const auto& topic = name_of(*std::ranges::find(choice_.lasers, std::string_view(), &FoundLaser::left_out));
    auto unused = namespaces_apart_from(topic);
    for (const auto& chosen : options_.topics) {
        if (namespaces_apart_from(chosen) == unused) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("--topic {} --topic {}: their transforms are in different namespaces, so they are of "
                                 "different robots; replay each robot by itself",
                                 topic, chosen)};
    }
    if (!unused.empty() && unused.size() == found_.trees.size()) {
        choice_.notes.push_back(fmt::format("{}: the transforms are in other namespaces, {}; if they are of other "
                                            "robots, use --poses none",
                                            topic, fmt::join(unused, ", ")));
        unused.clear();
    }
    // The longest name first: what is nearest to the laser counts.
    for (auto tree = found_.trees.rbegin(); tree != found_.trees.rend(); ++tree) {
        if (unused.contains(tree->first)) continue;
        if (found_.tree.size() == 0) {
            found_.tree = std::move(tree->second);
        } else {
            found_.tree.merge(tree->second);
        }
    }
    found_.trees.clear();
    return unused;
}

/// Leaves out lasers in namespaces whose transforms are not used.
void LaserChooser::leave_out_other_robots(const std::set<std::string>& unused_tf) {
    for (auto& laser : choice_.lasers) {
        const auto& topic = name_of(laser);
        const auto is_around = [&](const std::string& name) { return topic.starts_with(name + "/"); };
        if (!options_.topics.empty() || laser.mount || std::ranges::none_of(unused_tf, is_around)) continue;
        laser.left_out = kOtherRobot;
        choice_.notes.push_back(fmt::format("{}: its {} scans are of another robot; replay them as that robot with "
                                            "--topic {}",
                                            topic, found_.topics[laser.topic].messages, topic));
    }
}

/// Returns the laser whose transforms determine the robot's frame: the one with most scans among those that transforms
/// lead to, or else the one with most scans.
LeadingLaser LaserChooser::leading_laser() const {
    const auto is_used = [](const FoundLaser& laser) { return laser.left_out.empty(); };
    const auto leading = std::ranges::find_if(choice_.lasers, [&](const FoundLaser& laser) {
        return is_used(laser) && found_.tree.ancestors(frame_of(found_.topics[laser.topic])).size() > 1;
    });
    const auto& laser = leading != choice_.lasers.end() ? *leading : *std::ranges::find_if(choice_.lasers, is_used);
    return {name_of(laser), frame_of(found_.topics[laser.topic])};
}

/// Returns whether a topic has odometry nearer to its namespace than the odometry that is used.
bool LaserChooser::has_other_odometry(const std::string& topic) const {
    if (!choice_.frames.odom_topic) return false;
    const auto common = [&](std::size_t odometry) { return common_namespace(found_.topics[odometry].name, topic); };
    return std::ranges::any_of(found_.odometry, [&](const auto& odometry) {
        return common(odometry.first) > common(*choice_.frames.odom_topic);
    });
}

/// Returns what people can do about a laser whose mount is not known.
std::string LaserChooser::text_of_unknown_mount(const FoundLaser& laser) const {
    const auto& topic = found_.topics[laser.topic];
    const auto chain = found_.tree.ancestors(frame_of(topic));
    const auto fixed = std::ranges::find_if(chain, is_fixed_name);
    if (fixed != chain.end() && fixed != chain.begin()) {
        return fmt::format(
            "{}: its {} scans are left out, because transforms lead to it from the frame {}, and not from "
            "the robot's frame {}; if it is the laser of another robot, replay them as that robot with "
            "--topic {}",
            topic.name, topic.messages, *std::prev(fixed), choice_.frames.base, topic.name);
    }
    if (has_other_odometry(topic.name)) {
        return fmt::format("{}: its {} scans are left out, because other odometry is in its namespace; replay them as "
                           "another robot with --topic {}",
                           topic.name, topic.messages, topic.name);
    }
    return fmt::format("{}: its {} scans are left out, because no transform leads from the robot's "
                       "frame {} to it; state its mount with --mount {}=X,Y,YAW",
                       topic.name, topic.messages, choice_.frames.base, topic.name);
}

/// Says which options use transforms that look like poses, if none are used because of their names.
void LaserChooser::note_unnamed_poses(const std::string& laser_frame) {
    if (choice_.frames.poses != Poses::kNone || options_.poses) return;
    const auto chain = found_.tree.ancestors(laser_frame);
    for (const auto& frame : found_.tree.frames()) {
        const auto above = found_.tree.ancestors(frame);
        const bool is_below_robot = std::ranges::find(above, chain.back()) != above.end();
        if (!is_fixed_name(frame) || !is_below_robot || !found_.tree.moves(frame)) continue;
        choice_.notes.push_back(fmt::format("the transforms have {} below the robot's frame; to use it as the frame of "
                                            "odometry, state --fixed-frame {}",
                                            frame, frame));
        return;
    }
    const auto moving =
        std::find_if(chain.rbegin(), chain.rend(), [&](const std::string& frame) { return found_.tree.moves(frame); });
    if (moving == chain.rend()) return;
    choice_.notes.push_back(fmt::format("{} moves in {}, which does not have the name of a map or of odometry; to use "
                                        "its poses, state --base-frame {} --fixed-frame {}",
                                        *moving, *std::prev(moving), *moving, *std::prev(moving)));
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
        if (laser.left_out == kMountUnknown) choice_.notes.push_back(text_of_unknown_mount(laser));
    }
}

Result<LaserChoice> LaserChooser::make() {
    if (auto listed = list_lasers(); !listed) return listed.error();
    if (auto assigned = assign_mounts(); !assigned) return assigned.error();
    auto unused_tf = join_trees();
    if (!unused_tf) return unused_tf.error();
    leave_out_other_robots(*unused_tf);
    const auto leading = leading_laser();
    auto frames = choose_frames(found_, options_, leading);
    if (!frames) return frames.error();
    choice_.frames = std::move(*frames);
    choice_.frames.unused_tf = std::move(*unused_tf);
    note_unnamed_poses(leading.frame);
    leave_out_lasers();
    return std::move(choice_);
}

} // namespace

Result<LaserChoice> choose_lasers(RecordingSurvey& found, const RecordingOptions& options) {
    return LaserChooser(found, options).make();
}

} // namespace scanloom::robot
