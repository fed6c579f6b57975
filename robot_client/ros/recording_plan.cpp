#include "robot_client/ros/recording_plan.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/ros/frame_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>
#include <variant>

namespace scanloom::robot {
namespace {

std::string_view text_of(NoTransform reason) {
    switch (reason) {
    case NoTransform::kNotConnected: return "no transforms to its frame";
    case NoTransform::kBefore: return "before the first pose";
    case NoTransform::kAfter: return "after the last pose";
    case NoTransform::kHole: return "in a hole of the poses";
    }
    return {};
}

/// Returns the name of the frame that most scans of a topic have.
const std::string& frame_of(const SurveyedTopic& topic) {
    return std::ranges::max_element(topic.frames, {}, [](const auto& frame) { return frame.second; })->first;
}

/// Makes a plan, step by step.
class Planner {
public:
    Planner(RecordingSurvey& found, const RecordingOptions& options) : found_(found), options_(options) {}

    [[nodiscard]] Result<RecordingPlan> make();

private:
    struct Laser {
        std::size_t topic;
        std::string_view left_out; // why it is not used; empty: it is
        const StatedMount* mount = nullptr;
        bool is_connected = false; // by transforms, to the robot's frame
    };

    [[nodiscard]] Result<> list_lasers();
    [[nodiscard]] Result<> check_topic(std::string_view option, const std::string& topic) const;
    [[nodiscard]] Result<> assign_mounts();
    void choose_lasers();
    void place_scans();
    [[nodiscard]] std::string place(const Laser& laser, const SurveyedScan& scan, PlannedScan& planned);
    [[nodiscard]] std::string mount(const Laser& laser, const SurveyedScan& scan, PlannedScan& planned);
    void take_fingerprint();

    [[nodiscard]] const std::string& name_of(const Laser& laser) const { return found_.topics[laser.topic].name; }

    RecordingSurvey& found_;
    const RecordingOptions& options_;
    RecordingPlan plan_;
    std::vector<Laser> lasers_; // the one with most scans first
};

Result<> Planner::check_topic(std::string_view option, const std::string& topic) const {
    std::vector<std::string> names;
    for (const auto& laser : lasers_) names.push_back(name_of(laser));
    if (std::ranges::find(names, topic) != names.end()) return {};
    return Error{Errc::kNotFound, fmt::format("{} {}: the recording has no scans of this topic; it has: {}", option,
                                              topic, fmt::join(names, ", "))};
}

/// Lists the lasers, without those that the options leave out and those that repeat the scans of another one.
Result<> Planner::list_lasers() {
    for (const auto& [topic, laser] : found_.lasers) lasers_.push_back({topic, {}});
    if (lasers_.empty()) {
        return Error{Errc::kNotFound,
                     "the recording has no scans that can be read: no sensor_msgs/LaserScan or MultiEchoLaserScan; "
                     "scanloom-robot info FILE lists what it has"};
    }
    std::ranges::stable_sort(lasers_, std::greater<>(),
                             [&](const Laser& laser) { return found_.topics[laser.topic].messages; });
    for (const auto& topic : options_.topics) {
        if (auto checked = check_topic("--topic", topic); !checked) return checked;
    }
    std::set<std::string> frames;
    for (auto& laser : lasers_) {
        const bool is_chosen = std::ranges::find(options_.topics, name_of(laser)) != options_.topics.end();
        if (!options_.topics.empty() && !is_chosen) laser.left_out = "not a --topic";
        const bool is_new = laser.left_out.empty() && frames.insert(frame_of(found_.topics[laser.topic])).second;
        if (laser.left_out.empty() && !is_new && !is_chosen) laser.left_out = "in the frame of another topic";
    }
    return {};
}

Result<> Planner::assign_mounts() {
    for (const auto& stated : options_.mounts) {
        if (stated.topic.empty()) {
            const auto count = std::ranges::count(lasers_, std::string_view(), &Laser::left_out);
            if (count > 1) {
                return Error{Errc::kInvalidField,
                             fmt::format("--mount: the recording has {} lasers; say whose mount it is: --mount {}=X,Y,"
                                         "YAW, or choose one with --topic",
                                         count, name_of(lasers_.front()))};
            }
        } else if (auto checked = check_topic("--mount", stated.topic); !checked) {
            return checked;
        }
        for (auto& laser : lasers_) {
            const bool is_its = stated.topic.empty() ? laser.left_out.empty() : stated.topic == name_of(laser);
            if (is_its) laser.mount = &stated;
        }
    }
    return {};
}

/// Chooses the lasers whose mounts are known, or else the one with most scans.
void Planner::choose_lasers() {
    for (auto& laser : lasers_) {
        const auto chain = found_.tree.ancestors(frame_of(found_.topics[laser.topic]));
        laser.is_connected = std::ranges::find(chain, plan_.base_frame) != chain.end();
    }
    const auto is_used = [](const Laser& laser) { return laser.left_out.empty(); };
    const auto has_mount = [](const Laser& laser) { return laser.is_connected || laser.mount != nullptr; };
    const bool has_known =
        std::ranges::any_of(lasers_, [&](const Laser& laser) { return is_used(laser) && has_mount(laser); });
    const auto richest = std::ranges::find_if(lasers_, is_used);
    std::uint32_t id = 0;
    for (auto& laser : lasers_) {
        if (!is_used(laser)) continue;
        const bool is_chosen = has_known ? has_mount(laser) : &laser == &*richest;
        if (!is_chosen || id == kSensorsMax) laser.left_out = "mount unknown";
        if (!is_used(laser)) continue;
        plan_.lasers[static_cast<std::uint32_t>(laser.topic)] = {
            id++, found_.lasers.at(laser.topic).habits.meaning(options_.ranges)};
        if (laser.mount != nullptr && laser.is_connected) {
            plan_.notes.push_back(fmt::format("{}: --mount replaces the mount of the transforms", name_of(laser)));
        }
    }
    if (!has_known && plan_.poses != Poses::kNone) {
        plan_.notes.push_back(
            fmt::format("{}: its mount on the robot is not known, and taken as 0,0,0; state it with --mount {}=X,Y,YAW",
                        name_of(*richest), name_of(*richest)));
    }
    for (const auto& laser : lasers_) {
        if (laser.left_out != "mount unknown") continue;
        plan_.notes.push_back(fmt::format("{}: its {} scans are left out, because no transform leads from the robot's "
                                          "frame {} to it; state its mount with --mount {}=X,Y,YAW",
                                          name_of(laser), found_.topics[laser.topic].messages, plan_.base_frame,
                                          name_of(laser)));
    }
}

/// Sets the mount of a scan's laser. @return why that is not possible; empty: it is
std::string Planner::mount(const Laser& laser, const SurveyedScan& scan, PlannedScan& planned) {
    constexpr std::ptrdiff_t kRemembered = 16; // a laser that moves on its robot has many mounts
    LaserMount mount;
    if (laser.mount != nullptr) {
        mount.T_robot_laser = laser.mount->T_robot_laser;
    } else if (laser.is_connected) {
        const auto found = found_.tree.find(plan_.base_frame, found_.frames[scan.frame], scan.middle);
        if (const auto* reason = std::get_if<NoTransform>(&found)) return std::string(text_of(*reason));
        const auto flat = mount_of(std::get<Eigen::Isometry3d>(found));
        if (!flat) return flat.error().message;
        mount = *flat;
    }
    auto& mounts = plan_.mounts;
    const auto begin = mounts.end() - std::min(std::ssize(mounts), kRemembered);
    const auto known = std::find(begin, mounts.end(), mount);
    planned.mount = static_cast<std::uint32_t>(known - mounts.begin());
    if (known == mounts.end()) mounts.push_back(mount);
    return {};
}

/// Sets the pose and the mount of a scan. @return why that is not possible; empty: it is
std::string Planner::place(const Laser& laser, const SurveyedScan& scan, PlannedScan& planned) {
    if (!laser.left_out.empty()) return std::string(laser.left_out);
    if (scan.problem != 0) return found_.problems[scan.problem];
    if (plan_.poses != Poses::kNone) {
        const auto found = found_.tree.find(plan_.fixed_frame, plan_.base_frame, scan.middle);
        if (const auto* reason = std::get_if<NoTransform>(&found)) return std::string(text_of(*reason));
        planned.pose = planar(std::get<Eigen::Isometry3d>(found));
        if (std::max(std::fabs(planned.pose.x), std::fabs(planned.pose.y)) > kCoordinateMax) return "too far away";
    }
    return mount(laser, scan, planned);
}

void Planner::place_scans() {
    std::map<std::uint32_t, const Laser*> by_topic;
    for (const auto& laser : lasers_) by_topic[static_cast<std::uint32_t>(laser.topic)] = &laser;
    std::vector<double> stamps;
    std::vector<std::uint32_t> used;
    plan_.scans.resize(found_.scans.size());
    for (std::uint32_t n = 0; n < found_.scans.size(); ++n) {
        const auto& scan = found_.scans[n];
        const auto laser = by_topic.find(scan.topic);
        auto reason =
            laser == by_topic.end() ? found_.problems[scan.problem] : place(*laser->second, scan, plan_.scans[n]);
        if (!reason.empty()) {
            ++plan_.skipped[std::move(reason)];
            continue;
        }
        used.push_back(n);
        stamps.push_back(static_cast<double>(scan.middle) / 1e9);
    }
    const ScanOrder order = order_of(stamps);
    plan_.stamps = static_cast<const StampReport&>(order);
    plan_.scan_count = static_cast<std::uint32_t>(used.size());
    for (std::uint32_t place = 0; place < used.size(); ++place) plan_.scans[used[order.order[place]]].place = place;
}

void Planner::take_fingerprint() {
    Sha256 hash;
    hash.update(
        fmt::format("recording 1\n{}\n", scanloom::name_of(plan_.poses))); // 1: until equal recordings give other scans
    const auto add = [&](const auto& value) { hash.update({reinterpret_cast<const char*>(&value), sizeof value}); };
    for (const auto& [topic, laser] : plan_.lasers) {
        hash.update(found_.lasers.at(topic).hash.hex());
        add(laser.id);
        add(laser.meaning.range_max.value_or(0.0));
        add(laser.meaning.no_return);
        add(laser.meaning.is_zero_no_return);
        add(laser.meaning.is_beyond_no_return);
    }
    for (std::size_t n = 0; n < plan_.scans.size(); ++n) {
        const auto& scan = plan_.scans[n];
        if (scan.place == PlannedScan::kUnused) continue;
        const auto& mount = plan_.mounts[scan.mount];
        add(scan.place);
        add(found_.scans[n].middle);
        for (const double value : {scan.pose.x, scan.pose.y, scan.pose.yaw, mount.T_robot_laser.x,
                                   mount.T_robot_laser.y, mount.T_robot_laser.yaw}) {
            add(value);
        }
        add(mount.is_upside_down);
    }
    plan_.fingerprint = "recording " + hash.hex().substr(0, 40);
}

Result<RecordingPlan> Planner::make() {
    if (auto listed = list_lasers(); !listed) return listed.error();
    if (auto assigned = assign_mounts(); !assigned) return assigned.error();
    const auto& richest = *std::ranges::find(lasers_, std::string_view(), &Laser::left_out);
    auto frames = choose_frames(found_, options_, frame_of(found_.topics[richest.topic]));
    if (!frames) return frames.error();
    plan_.poses = frames->poses;
    plan_.base_frame = frames->base;
    plan_.fixed_frame = frames->fixed;
    if (frames->odom_topic) plan_.odom_topic = found_.topics[*frames->odom_topic].name;
    choose_lasers();
    place_scans();
    if (plan_.scan_count == 0) {
        return Error{Errc::kNotFound, fmt::format("no scan can be used: {}", skipped_text(plan_.skipped))};
    }
    take_fingerprint();
    return std::move(plan_);
}

} // namespace

std::string skipped_text(const std::map<std::string, std::uint64_t>& skipped) {
    std::vector<std::string> parts;
    for (const auto& [reason, count] : skipped) parts.push_back(fmt::format("{} {}", count, reason));
    return fmt::to_string(fmt::join(parts, ", "));
}

Result<RecordingPlan> plan(RecordingSurvey& found, const RecordingOptions& options) {
    return Planner(found, options).make();
}

} // namespace scanloom::robot
