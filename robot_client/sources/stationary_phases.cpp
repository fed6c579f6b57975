#include "robot_client/sources/stationary_phases.hpp"

#include "common/error/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr double kAlmostSure = 3.0; // sigmas

/// Rounds for messages, without a -0.00.
double rounded(double value) { return std::round(100.0 * value) / 100.0 + 0.0; }

std::string text_of(const Pose2& pose) {
    return fmt::format("({:.2f}, {:.2f}), yaw {:.2f}", rounded(pose.x), rounded(pose.y), rounded(pose.yaw));
}

} // namespace

void StationaryPhases::add(Observation turn) {
    const TurnProfile profile = profile_of(turn.scan, *turn.sensor);
    switch (detector_.judge(profile)) {
    case StationaryDetector::Verdict::kUnclear: ++dropped_; return;
    case StationaryDetector::Verdict::kMoved:
        leave();
        if (detector_.judge(profile) == StationaryDetector::Verdict::kUnclear) {
            ++dropped_;
            return;
        }
        break;
    case StationaryDetector::Verdict::kStill: break;
    }
    if (detector_.turns() < StationaryDetector::kTurnsMax) detector_.learn(profile);
    held_.push_back(std::move(turn));
    if (T_map_odom_) {
        release(kTurnsHeldBack);
    } else if (held_.size() > kTurnsAlike) {
        held_.pop_front();
        ++dropped_;
    }
}

/// Ends the phase: the sensor was moved.
void StationaryPhases::leave() {
    const bool was_stationary = detector_.turns() == kTurnsAlike;
    reported_.clear();
    if (was_stationary) {
        ++carried_;
        report("the lidar was moved: no scans are sent until it is stationary and localized");
    }
    drop_held();
    T_map_odom_.reset();
    begins_map_ = false;
    refused_at_.reset();
    detector_ = {};
}

void StationaryPhases::drop_held() {
    dropped_ += held_.size();
    held_.clear();
}

std::optional<SeenPoints> StationaryPhases::question() const {
    const bool may_request = held_.size() == kTurnsAlike && !T_map_odom_;
    if (!may_request) return std::nullopt;
    if (refused_at_ && std::abs(held_.back().scan.stamp - *refused_at_) < kRetryAfter) return std::nullopt;
    SeenPoints seen;
    for (const Observation& turn : held_) seen.add(turn.scan, *turn.sensor);
    return seen;
}

void StationaryPhases::answer(const Result<LocateResult>& located) {
    assert(!held_.empty() && !T_map_odom_);
    if (!located) {
        const bool is_first = located.error().code == Errc::kNothingMapped && first_place_;
        return is_first ? place_first() : refuse(located.error());
    }
    T_map_odom_ = located->T_map_odom;
    report(fmt::format("localized at {}: {:.0f} % of the scan matches the map; accuracy {:.1f} cm and {:.2f} degrees",
                       text_of(compose(*T_map_odom_, *held_.back().scan.pose)), 100.0 * located->inlier_ratio,
                       kAlmostSure * 100.0 * located->position_sigma,
                       kAlmostSure * located->yaw_sigma * 180.0 / std::numbers::pi));
    release(kTurnsHeldBack);
}

void StationaryPhases::place_first() {
    const Pose2 place = *std::exchange(first_place_, std::nullopt);
    T_map_odom_ = compose(place, inverse(*held_.back().scan.pose));
    begins_map_ = true;
    report(fmt::format(
        "the map is empty: the lidar's pose is assumed to be {}; its next places are localized relative to it",
        text_of(place)));
    release(kTurnsHeldBack);
}

void StationaryPhases::refuse(Error refusal) {
    if (refusal.code == Errc::kNothingMapped) {
        refusal.message = further(refusal.message, "the given pose was that of the first place");
    }
    report(further(refusal.message,
                   fmt::format("no scans are sent from here; retrying in {:g} s, or at another place", kRetryAfter)));
    refusal_ = std::move(refusal);
    refused_at_ = held_.back().scan.stamp;
    drop_held();
}

/// Releases the turns of this phase except the newest `held_back`.
void StationaryPhases::release(std::size_t held_back) {
    for (; held_.size() > held_back; held_.pop_front()) {
        Observation turn = std::move(held_.front());
        turn.scan.pose = compose(*T_map_odom_, *turn.scan.pose);
        turn.scan.begins_map = begins_map_;
        ready_.push_back(std::move(turn));
    }
}

void StationaryPhases::end() {
    if (T_map_odom_) release(0);
    drop_held();
}

std::optional<Observation> StationaryPhases::take() {
    std::optional<Observation> first;
    if (ready_.empty()) return first;
    ++given_;
    first = std::move(ready_.front());
    ready_.pop_front();
    return first;
}

void StationaryPhases::report(std::string sentence) {
    if (std::ranges::find(reported_, sentence) != reported_.end()) return;
    reported_.push_back(sentence);
    if (reported_.size() > kReportedMax) reported_.pop_front();
    messages_.push_back(std::move(sentence));
}

std::vector<std::string> StationaryPhases::take_messages() { return std::exchange(messages_, {}); }

} // namespace scanloom::robot
