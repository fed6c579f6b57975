#include "robot_client/ros/recording_plan.hpp"

#include "robot_client/ros/laser_choice.hpp"
#include "robot_client/ros/scan_place.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

namespace scanloom::robot {
namespace {

/// Makes a plan, step by step.
class Planner {
public:
    Planner(RecordingSurvey& found, const RecordingOptions& options) : found_(found), options_(options) {}

    [[nodiscard]] Result<RecordingPlan> make();

private:
    [[nodiscard]] std::string place(const FoundLaser& laser, const SurveyedScan& scan, PlannedScan& planned);
    [[nodiscard]] std::uint32_t index_of(const LaserMount& mount);
    [[nodiscard]] bool is_clock_set_back() const;
    void place_scans();
    [[nodiscard]] std::string cure_of_missing_places() const;
    void take_fingerprint();

    RecordingSurvey& found_;
    const RecordingOptions& options_;
    LaserChoice choice_;
    RecordingPlan plan_;
    std::uint64_t without_place_ = 0; // scans that transforms or odometry do not locate
    std::uint64_t without_mount_ = 0; // of these, scans whose mount is not known at their time
};

/// Returns the index of a mount among those of the plan.
std::uint32_t Planner::index_of(const LaserMount& mount) {
    constexpr std::ptrdiff_t kRemembered = 16; // a laser that moves on its robot has many mounts
    auto& mounts = plan_.mounts;
    const auto begin = mounts.end() - std::min(std::ssize(mounts), kRemembered);
    const auto known = std::find(begin, mounts.end(), mount);
    const auto index = static_cast<std::uint32_t>(known - mounts.begin());
    if (known == mounts.end()) mounts.push_back(mount);
    return index;
}

/// Sets the pose and the mount of a scan. @return why that is not possible; empty: it is
std::string Planner::place(const FoundLaser& laser, const SurveyedScan& scan, PlannedScan& planned) {
    if (!laser.left_out.empty()) return std::string(laser.left_out);
    if (scan.problem != 0) return found_.problems[scan.problem];
    const auto found = place_of_scan(found_.tree, choice_.frames, laser, found_.frames[scan.frame],
                                     EpochTime(scan.middle, scan.epoch));
    if (const auto* none = std::get_if<NoPlace>(&found)) {
        ++without_place_;
        without_mount_ += none->is_mount ? 1 : 0;
        return none->reason;
    }
    const auto& place = std::get<ScanPlace>(found);
    planned.pose = place.pose;
    planned.mount = index_of(place.mount);
    return {};
}

/// Returns whether the stamps of scans that are not left out overlap. Otherwise at most the parts of the recording are
/// out of order, and transforms of one part may be missing in another.
bool Planner::is_clock_set_back() const {
    std::vector<double> stamps;
    for (const auto& scan : found_.scans) {
        const auto laser = std::ranges::find(choice_.lasers, scan.topic, &FoundLaser::topic);
        if (scan.problem != 0 || !laser->left_out.empty()) continue;
        stamps.push_back(static_cast<double>(scan.middle) / 1e9);
    }
    return order_of(stamps).is_clock_set_back;
}

void Planner::place_scans() {
    if (!is_clock_set_back()) {
        found_.tree.join_epochs();
        for (auto& scan : found_.scans) scan.epoch = 0;
    }
    std::map<std::uint32_t, const FoundLaser*> by_topic;
    for (const auto& laser : choice_.lasers) by_topic[static_cast<std::uint32_t>(laser.topic)] = &laser;
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

/// Returns which options may help if most scans have no place: the end of a sentence, empty if there is nothing to say.
std::string Planner::cure_of_missing_places() const {
    if (without_place_ <= plan_.scan_count) return {};
    if (2 * without_mount_ > without_place_) return "; state the mount with --mount X,Y,YAW";
    std::vector<std::string> other;
    if (plan_.poses == Poses::kMap) other.emplace_back("--poses odometry");
    for (const auto& [topic, tree] : found_.odometry) {
        if (choice_.frames.odom_topic != topic) other.push_back("--odom-topic " + found_.topics[topic].name);
    }
    if (plan_.poses != Poses::kNone) other.emplace_back("--poses none");
    return other.empty() ? "" : fmt::format("; try {}", fmt::join(other, " or "));
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
    auto choice = choose_lasers(found_, options_);
    if (!choice) return choice.error();
    choice_ = std::move(*choice);
    const FrameChoice& frames = choice_.frames;
    plan_.poses = frames.poses;
    plan_.base_frame = frames.base;
    plan_.fixed_frame = frames.fixed;
    if (frames.odom_topic) plan_.odom_topic = found_.topics[*frames.odom_topic].name;
    plan_.notes = choice_.notes;
    for (const auto& laser : choice_.lasers) {
        if (!laser.left_out.empty()) continue;
        plan_.lasers[static_cast<std::uint32_t>(laser.topic)] = {
            laser.id, found_.lasers.at(laser.topic).habits.meaning(options_.ranges)};
    }
    place_scans();
    const auto cure = cure_of_missing_places();
    if (plan_.scan_count == 0) {
        return Error{Errc::kNotFound, fmt::format("no scan can be used: {}{}", skipped_text(plan_.skipped), cure)};
    }
    if (!cure.empty()) {
        plan_.notes.push_back(fmt::format("{} of {} scans are skipped, because it is not known where they were taken{}",
                                          without_place_, without_place_ + plan_.scan_count, cure));
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
