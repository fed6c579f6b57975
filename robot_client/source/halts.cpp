#include "robot_client/source/halts.hpp"

#include "common/error/further.hpp"

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

void Halts::add(Observation turn) {
    const TurnProfile profile = profile_of(turn.scan, *turn.sensor);
    switch (stillness_.judge(profile)) {
    case Stillness::Verdict::kUnclear: ++dropped_; return;
    case Stillness::Verdict::kMoved:
        leave();
        if (stillness_.judge(profile) == Stillness::Verdict::kUnclear) {
            ++dropped_;
            return;
        }
        break;
    case Stillness::Verdict::kStill: break;
    }
    if (stillness_.turns() < Stillness::kTurnsMax) stillness_.learn(profile);
    held_.push_back(std::move(turn));
    if (T_map_odom_) {
        release(kTurnsHeldBack);
    } else if (held_.size() > kTurnsAlike) {
        held_.pop_front();
        ++dropped_;
    }
}

/// Ends the halt: the sensor was moved.
void Halts::leave() {
    const bool was_a_halt = stillness_.turns() == kTurnsAlike;
    told_.clear();
    if (was_a_halt) {
        ++carried_;
        tell("the lidar is moved: nothing is sent until it stands again and its place is known");
    }
    drop_held();
    T_map_odom_.reset();
    begins_map_ = false;
    refused_at_.reset();
    stillness_ = {};
}

void Halts::drop_held() {
    dropped_ += held_.size();
    held_.clear();
}

std::optional<SeenPoints> Halts::question() const {
    const bool may_ask = held_.size() == kTurnsAlike && !T_map_odom_;
    if (!may_ask) return std::nullopt;
    if (refused_at_ && std::abs(held_.back().scan.stamp - *refused_at_) < kAskAgainAfter) return std::nullopt;
    SeenPoints seen;
    for (const Observation& turn : held_) seen.add(turn.scan, *turn.sensor);
    return seen;
}

void Halts::answer(const Result<Located>& located) {
    assert(!held_.empty() && !T_map_odom_);
    if (!located) {
        const bool is_first = located.error().code == Errc::kNothingMapped && first_place_;
        return is_first ? place_first() : refuse(located.error());
    }
    T_map_odom_ = located->T_map_odom;
    tell(fmt::format("located at {}: {:.0f} % of what the lidar sees is in the map; known within {:.1f} cm and {:.2f} "
                     "degrees",
                     text_of(compose(*T_map_odom_, held_.back().scan.pose)), 100.0 * located->explained,
                     kAlmostSure * 100.0 * located->position_sigma,
                     kAlmostSure * located->yaw_sigma * 180.0 / std::numbers::pi));
    release(kTurnsHeldBack);
}

void Halts::place_first() {
    const Pose2 place = *std::exchange(first_place_, std::nullopt);
    T_map_odom_ = compose(place, inverse(held_.back().scan.pose));
    begins_map_ = true;
    tell(fmt::format(
        "nothing is mapped yet: the lidar is taken to stand at {}, and its next places are found from there",
        text_of(place)));
    release(kTurnsHeldBack);
}

void Halts::refuse(Error refusal) {
    if (refusal.code == Errc::kNothingMapped) {
        refusal.message = further(refusal.message, "the pose that was given was that of the first place");
    }
    tell(further(refusal.message, fmt::format("nothing is sent from here; asking again in {:g} s, or at another place",
                                              kAskAgainAfter)));
    refusal_ = std::move(refusal);
    refused_at_ = held_.back().scan.stamp;
    drop_held();
}

/// Releases the turns of this halt except the newest `held_back`.
void Halts::release(std::size_t held_back) {
    for (; held_.size() > held_back; held_.pop_front()) {
        Observation turn = std::move(held_.front());
        turn.scan.pose = compose(*T_map_odom_, turn.scan.pose);
        turn.scan.begins_map = begins_map_;
        ready_.push_back(std::move(turn));
    }
}

void Halts::end() {
    if (T_map_odom_) release(0);
    drop_held();
}

std::optional<Observation> Halts::take() {
    std::optional<Observation> first;
    if (ready_.empty()) return first;
    ++given_;
    first = std::move(ready_.front());
    ready_.pop_front();
    return first;
}

void Halts::tell(std::string sentence) {
    if (std::ranges::find(told_, sentence) != told_.end()) return;
    told_.push_back(sentence);
    if (told_.size() > kToldMax) told_.pop_front();
    news_.push_back(std::move(sentence));
}

std::vector<std::string> Halts::take_news() { return std::exchange(news_, {}); }

} // namespace scanloom::robot
