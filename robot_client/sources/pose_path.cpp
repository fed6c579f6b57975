#include "robot_client/sources/pose_path.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace scanloom::robot {

Result<StampedPose> stamped_pose(double x, double y, double yaw, double stamp) {
    if (std::max(std::abs(x), std::abs(y)) > kCoordinateMax) {
        return Error{Errc::kInvalidField, fmt::format("the pose is more than {} m from the origin", kCoordinateMax)};
    }
    return StampedPose{{x, y, normalize_angle(yaw)}, stamp};
}

Pose2 interpolate(const StampedPose& from, const StampedPose& to, double stamp) {
    const double gap = to.stamp - from.stamp;
    const double share = gap > 0.0 ? (stamp - from.stamp) / gap : 0.0;
    return {from.robot.x + share * (to.robot.x - from.robot.x), from.robot.y + share * (to.robot.y - from.robot.y),
            normalize_angle(from.robot.yaw + share * normalize_angle(to.robot.yaw - from.robot.yaw))};
}

PosePath::PosePath(std::vector<StampedPose> samples) : samples_(std::move(samples)) {
    std::ranges::stable_sort(samples_, {}, &StampedPose::stamp);
}

std::optional<Pose2> PosePath::at(double stamp) const {
    const auto after = std::ranges::lower_bound(samples_, stamp, {}, &StampedPose::stamp);
    const auto is_near = [&](auto sample) { return std::abs(sample->stamp - stamp) <= kPoseGapMax; };
    const bool has_after = after != samples_.end() && is_near(after);
    const bool has_before = after != samples_.begin() && is_near(after - 1);
    if (!has_after && !has_before) return std::nullopt;
    const StampedPose& from = has_before ? *(after - 1) : *after;
    const StampedPose& to = has_after ? *after : *(after - 1);
    return interpolate(from, to, stamp);
}

void PoseTimeline::insert(const StampedPose& pose) {
    poses_.insert(std::ranges::upper_bound(poses_, pose.stamp, {}, &StampedPose::stamp), pose);
}

void PoseTimeline::keep_newest(std::size_t count) {
    while (poses_.size() > count) poses_.pop_front();
}

void PoseTimeline::forget_after(double stamp) {
    while (!poses_.empty() && poses_.back().stamp > stamp) poses_.pop_back();
}

std::optional<Pose2> PoseTimeline::at(double stamp) const {
    if (empty() || stamp < oldest().stamp || stamp > newest().stamp) return std::nullopt;
    const auto to = std::ranges::lower_bound(poses_, stamp, {}, &StampedPose::stamp);
    return to == poses_.begin() ? to->robot : interpolate(*(to - 1), *to, stamp);
}

Result<std::optional<StampedPose>> read_pose_line(std::string_view line) {
    const Tokens tokens = split(line);
    if (tokens.empty() || tokens.front().starts_with('#')) return std::optional<StampedPose>{};
    constexpr std::size_t kNumbers = 4;
    const auto numbers =
        read_numbers(std::span(tokens).first(std::min(tokens.size(), kNumbers)), kNumbers, "t x y yaw");
    if (!numbers) return numbers.error();
    const auto& n = *numbers;
    const auto pose = stamped_pose(n[1], n[2], n[3], n[0]);
    if (!pose) return pose.error();
    return std::optional(*pose);
}

namespace {

/// @param next  returns the next line, or nullopt after the last one
template <class Next>
Result<PoseLines> collected(std::string_view name, const std::function<void(const SkippedLine&)>& report, Next&& next) {
    PoseLines lines;
    for (std::size_t line_number = 1;; ++line_number) {
        const Result<std::optional<std::string_view>> line = next();
        if (!line) return line.error();
        if (!*line) break;
        const auto pose = read_pose_line(**line);
        if (!pose) {
            ++lines.skipped;
            report({line_number, pose.error().message});
        } else if (*pose) {
            lines.poses.insert(**pose);
        }
    }
    if (!lines.poses.empty()) return lines;
    return Error{Errc::kNotFound, fmt::format("{}: no valid pose; each line must be: t x y yaw", name)};
}

} // namespace

Result<PoseLines> read_pose_lines(const std::filesystem::path& path,
                                  const std::function<void(const SkippedLine&)>& report, LineLimits limits) {
    auto reader = LineReader::open(path, limits);
    if (!reader) return reader.error();
    return collected(path.string(), report, [&] { return reader->next(); });
}

Result<PoseLines> read_pose_lines(std::istream& lines, std::string_view name,
                                  const std::function<void(const SkippedLine&)>& report) {
    std::string line;
    return collected(name, report, [&]() -> Result<std::optional<std::string_view>> {
        if (!std::getline(lines, line)) return std::optional<std::string_view>{};
        return std::optional<std::string_view>(line);
    });
}

} // namespace scanloom::robot
