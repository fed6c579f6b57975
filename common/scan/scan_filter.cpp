#include "common/scan/scan_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

namespace scanloom {
namespace {

bool has(const StampRange& range, const ScanPose& scan) { return range.from <= scan.stamp && scan.stamp <= range.to; }
bool has(const SeqRange& range, const ScanPose& scan) { return range.from <= scan.seq && scan.seq <= range.to; }

} // namespace

Result<> Exclusions::check(const ScansExcluded& excluded) const {
    const std::uint64_t last = all_.empty() ? 0 : all_.back().excluded.id;
    if (excluded.id > last) return {};
    return Error{Errc::kMalformed, fmt::format("exclusion {} follows exclusion {}", excluded.id, last)};
}

Result<> Exclusions::check(const ExclusionLifted& lifted) const {
    const bool is_in_effect = std::ranges::any_of(
        all_, [&](const Exclusion& one) { return one.excluded.id == lifted.id && one.lifted == 0; });
    if (is_in_effect) return {};
    return Error{Errc::kMalformed, fmt::format("exclusion {} is lifted, but not in effect", lifted.id)};
}

Result<> Exclusions::add(Revision revision, const ScansExcluded& excluded) {
    if (auto follows = check(excluded); !follows) return follows;
    all_.push_back({excluded, revision});
    revision_ = std::max(revision_, revision);
    return {};
}

Result<> Exclusions::add(Revision revision, const ExclusionLifted& lifted) {
    if (auto follows = check(lifted); !follows) return follows;
    std::ranges::find(all_, lifted.id, [](const Exclusion& one) { return one.excluded.id; })->lifted = revision;
    revision_ = std::max(revision_, revision);
    return {};
}

bool Exclusions::cover(Revision revision, const ScanPose& scan) const noexcept {
    if (revision >= revision_) return false; // newer than all exclusions
    return std::ranges::any_of(all_, [&](const Exclusion& one) {
        return one.lifted == 0 && revision < one.since && scan.robot == one.excluded.robot &&
               std::visit([&](const auto& range) { return has(range, scan); }, one.excluded.scans);
    });
}

Exclusions Exclusions::as_of(Revision revision) const {
    Exclusions earlier;
    for (Exclusion one : all_) {
        if (one.since > revision) break;
        if (one.lifted > revision) one.lifted = 0;
        earlier.revision_ = std::max({earlier.revision_, one.since, one.lifted});
        earlier.all_.push_back(one);
    }
    return earlier;
}

std::size_t Exclusions::count_in_effect() const noexcept {
    return static_cast<std::size_t>(std::ranges::count(all_, Revision{0}, &Exclusion::lifted));
}

SharedExclusions no_exclusions() {
    static const auto none = std::make_shared<const Exclusions>();
    return none;
}

bool JumpFilter::integrates(RobotIndex robot, const Point2& place) const noexcept {
    if (!is_on() || robot >= robots_.size() || !robots_[robot].integrated) return true;
    const Robot& known = robots_[robot];
    return norm(place - *known.integrated) <= max_jump_m_ || norm(place - *known.newest) <= max_jump_m_;
}

bool JumpFilter::take(RobotIndex robot, const Point2& place) {
    if (!is_on()) return true;
    const bool is_integrated = integrates(robot, place);
    Robot& known = robot_at(robot);
    known.newest = place;
    if (is_integrated) {
        known.integrated = place;
    } else {
        ++known.left_out;
    }
    return is_integrated;
}

void JumpFilter::restore(RobotIndex robot, const Robot& state) { robot_at(robot) = state; }

JumpFilter::Robot& JumpFilter::robot_at(RobotIndex robot) {
    if (robot >= robots_.size()) robots_.resize(robot + 1);
    return robots_[robot];
}

ScanUse ScanFilter::use_of(Revision revision, const ScanPose& scan) const noexcept {
    if (exclusions_->cover(revision, scan)) return ScanUse::kExcluded;
    if (!scan.pose) return ScanUse::kUnplaced;
    if (!jumps_.integrates(scan.robot, {scan.pose->x, scan.pose->y})) return ScanUse::kJump;
    return scan.is_localize_only ? ScanUse::kLocalizeOnly : ScanUse::kIntegrated;
}

ScanUse ScanFilter::take(Revision revision, const ScanPose& scan) {
    const ScanUse use = use_of(revision, scan);
    if (is_in_trajectory(use) || use == ScanUse::kJump) jumps_.take(scan.robot, {scan.pose->x, scan.pose->y});
    return use;
}

} // namespace scanloom
