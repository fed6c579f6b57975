#include "robot_client/ros/frame_choice.hpp"

#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/ros/frame_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

/// Returns the robot's frame by the names of the frames above it: the one below odometry or a map. Where there is
/// nav_msgs/Odometry, a frame that does not move, such as a charging station, is none.
/// @param laser_frame  of a laser that may be connected to it or not
/// @return nullopt: there is none, or there are several
std::optional<std::string> moving_frame(const RecordingSurvey& found, const std::string& laser_frame) {
    const auto chain = found.tree.ancestors(laser_frame);
    const auto fixed = std::ranges::find_if(chain, is_fixed_name);
    if (fixed != chain.end() && fixed != chain.begin()) {
        const std::string& below = *std::prev(fixed);
        if (!found.tree.is_static(below) || found.odometry.empty()) return below;
    }
    for (auto* const is_parent : {is_odometry_name, is_map_name}) {
        auto below = found.tree.children_of(is_parent);
        std::erase_if(below, [&](const auto& frame) { return is_fixed_name(frame) || found.tree.is_static(frame); });
        if (below.size() == 1) return *below.begin();
        if (!below.empty()) return std::nullopt;
    }
    return std::nullopt;
}

/// Returns the topic of odometry that is most likely that of the laser's robot: of a frame above the laser, or else in
/// its namespace, or else with most messages.
std::optional<std::size_t> likely_odometry(const RecordingSurvey& found, const LeadingLaser& laser) {
    const auto chain = found.tree.ancestors(laser.frame);
    std::optional<std::size_t> best;
    const auto rank = [&](std::size_t topic) {
        const auto& [name, messages] = std::tie(found.topics[topic].name, found.topics[topic].messages);
        const bool is_above = std::ranges::find(chain, found.odom_child.at(topic)) != chain.end();
        return std::tuple(is_above, common_namespace(name, laser.topic), messages);
    };
    for (const auto& [topic, tree] : found.odometry) {
        if (!best || rank(topic) > rank(*best)) best = topic;
    }
    return best;
}

/// Returns the topic of --odom-topic.
Result<std::size_t> stated_odometry(const RecordingSurvey& found, const std::string& name) {
    std::vector<std::string> names;
    for (const auto& [topic, tree] : found.odometry) {
        if (found.topics[topic].name == name) return topic;
        names.push_back(found.topics[topic].name);
    }
    return Error{Errc::kNotFound,
                 fmt::format("--odom-topic {}: the {} has no readable nav_msgs/Odometry of this topic; it "
                             "has: {}",
                             name, found.origin, names.empty() ? "none" : fmt::to_string(fmt::join(names, ", ")))};
}

/// Returns the frame that poses are in.
/// @param above  frames above the robot's, the nearest first
std::optional<std::string> fixed_frame(const std::vector<std::string>& above, Poses poses) {
    const auto find = [&](auto&& is_it) -> std::optional<std::string> {
        const auto found = std::ranges::find_if(above, is_it);
        return found == above.end() ? std::nullopt : std::optional(*found);
    };
    if (poses == Poses::kMap) return find(is_map_name);
    const auto odometry = find(is_odometry_name);
    return odometry || above.empty() ? odometry : above.front();
}

/// Returns whether the robot is localized in a map: there is one above it, and not only by a transform from odometry to
/// the map that never changes.
bool has_map(const FrameTree& tree, const std::vector<std::string>& above) {
    const auto map = std::ranges::find_if(above, is_map_name);
    if (map == above.end()) return false;
    return map == above.begin() || !is_odometry_name(*std::prev(map)) || !tree.is_static(*std::prev(map));
}

/// Chooses the poses if people did not.
Poses available_poses(const FrameTree& tree, const std::vector<std::string>& above, const RecordingOptions& options) {
    if (options.poses) return *options.poses;
    if (!options.fixed_frame.empty()) return is_map_name(options.fixed_frame) ? Poses::kMap : Poses::kOdometry;
    if (has_map(tree, above)) return Poses::kMap;
    return above.empty() ? Poses::kNone : Poses::kOdometry;
}

/// Chooses the topic whose poses replace transforms: that of the options, or one where transforms contain no poses.
Result<std::optional<std::size_t>> choose_odometry(const RecordingSurvey& found, const RecordingOptions& options,
                                                   const LeadingLaser& laser, bool has_poses) {
    if (!options.odom_topic.empty()) {
        const auto topic = stated_odometry(found, options.odom_topic);
        if (!topic) return topic.error();
        return std::optional(*topic);
    }
    return has_poses ? std::nullopt : likely_odometry(found, laser);
}

/// Returns the frames above the robot's that poses may be in, the nearest first.
/// @param odometry  the frame of the chosen odometry topic, whatever its name; else empty
std::vector<std::string> fixed_frames(const FrameTree& tree, const std::string& base, std::string_view odometry) {
    auto above = tree.ancestors(base);
    const auto is_fixed = [&](const std::string& frame) { return is_fixed_name(frame) || frame == odometry; };
    above.erase(above.begin(), std::find_if(above.begin() + 1, above.end(), is_fixed));
    return above;
}

/// Returns whether a frame is below the robot's and moves against it, as the odometry of some robots does.
bool moves_below(const FrameTree& tree, const std::string& base, const std::string& frame) {
    const auto chain = tree.ancestors(frame);
    const auto end = std::ranges::find(chain, base);
    return end != chain.end() && std::any_of(chain.begin(), end, [&](const auto& one) { return tree.moves(one); });
}

/// Replaces the transforms of the robot's frame by the poses of the chosen topic.
/// @param choice  its odom_child and base are set
/// @return the frame that the poses are in
std::string replace_by_odometry(RecordingSurvey& found, const RecordingOptions& options, FrameChoice& choice) {
    const FrameTree& poses = found.odometry.at(*choice.odom_topic);
    const std::string& child = found.odom_child.at(*choice.odom_topic);
    const auto in = poses.ancestors(child).at(1);
    // Many robots name a frame in their odometry that no transform has.
    const std::string& stated = options.base_frame;
    const bool is_of_stated = !found.tree.has(child) && found.tree.has(stated) && stated != in;
    choice.odom_child = choice.base = is_of_stated ? stated : child;
    found.tree.replace(choice.odom_child, poses, child);
    return in;
}

} // namespace

Result<FrameChoice> choose_frames(RecordingSurvey& found, const RecordingOptions& options, const LeadingLaser& laser) {
    const auto chain = found.tree.ancestors(laser.frame);
    const auto moving = moving_frame(found, laser.frame);
    FrameChoice choice;
    const auto topic = choose_odometry(found, options, laser, moving.has_value());
    if (!topic) return topic.error();
    choice.odom_topic = *topic;
    std::string odometry;
    if (choice.odom_topic) {
        odometry = replace_by_odometry(found, options, choice);
    } else {
        choice.base = moving.value_or(chain.back());
    }
    if (!options.base_frame.empty()) choice.base = options.base_frame;
    if (!found.tree.has(choice.base) && choice.base != laser.frame) {
        return Error{Errc::kNotFound, fmt::format("--base-frame {}: no transform has this frame; frames from the "
                                                  "laser up are: {}",
                                                  choice.base, fmt::join(chain, ", "))};
    }
    const auto above_base = found.tree.ancestors(choice.base);
    const bool needs_odometry = choice.odom_topic && options.poses != Poses::kNone;
    if (needs_odometry && std::ranges::find(above_base, choice.odom_child) == above_base.end()) {
        return Error{Errc::kInvalidField,
                     fmt::format("--base-frame {}: the poses of {} are those of the frame {}, from which no transforms "
                                 "lead to {}; leave --base-frame out, or use --poses none",
                                 choice.base, found.topics[*choice.odom_topic].name, choice.odom_child, choice.base)};
    }
    const auto frames = fixed_frames(found.tree, choice.base, odometry);
    choice.poses = available_poses(found.tree, frames, options);
    if (choice.poses == Poses::kNone) return choice;
    if (!options.fixed_frame.empty()) {
        choice.fixed = options.fixed_frame;
        const bool is_above = std::find(above_base.begin() + 1, above_base.end(), choice.fixed) != above_base.end();
        if (is_above || moves_below(found.tree, choice.base, choice.fixed)) return choice;
        return Error{Errc::kNotFound, fmt::format("--fixed-frame {}: no transforms lead from it to the robot's frame; "
                                                  "frames from that up are: {}",
                                                  choice.fixed, fmt::join(above_base, ", "))};
    }
    if (auto fixed = fixed_frame(frames, choice.poses)) {
        choice.fixed = std::move(*fixed);
        return choice;
    }
    return Error{Errc::kNotFound,
                 choice.poses == Poses::kMap
                     ? fmt::format("--poses map: no frame named map is above the robot's frame {}; use --poses {}, or "
                                   "name the frame with --fixed-frame",
                                   choice.base, frames.empty() ? "none" : "odometry")
                     : fmt::format("--poses odometry: the {} has no nav_msgs/Odometry, and no transforms lead from a "
                                   "frame of odometry to the robot's frame {}; name the robot's frame with "
                                   "--base-frame, or use --poses none",
                                   found.origin, choice.base)};
}

std::string poses_text(Poses poses, std::string_view base, std::string_view fixed, std::string_view odom_topic) {
    if (poses == Poses::kNone) return "poses: none; the server estimates where the scans were taken";
    return fmt::format("poses: {}, of {} in {}, by {}", name_of(poses), shown_word(base), shown_word(fixed),
                       odom_topic.empty() ? "the transforms" : shown_word(odom_topic));
}

} // namespace scanloom::robot
