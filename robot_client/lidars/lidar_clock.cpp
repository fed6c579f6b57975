#include "robot_client/lidars/lidar_clock.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace scanloom::robot {
namespace {

constexpr double kWindow = 5.0; // seconds; the last two windows are used

/// No packet arrives later than this. If one seems to, one of the two clocks was set.
constexpr double kLateMax = 1.0; // seconds

} // namespace

double unix_now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

double LidarClock::stamp(std::uint32_t milliseconds, double arrival) {
    const double offset = arrival - milliseconds * 1e-3;
    if (!is_set_) set(offset, arrival);
    const double least = std::min(least_before_, least_);
    const double lateness = std::remainder(offset - least, wrap_);
    if (std::abs(lateness) > kLateMax) {
        set(offset, arrival);
        return arrival;
    }
    if (arrival - window_begin_ > kWindow || arrival < window_begin_) {
        least_before_ = least_;
        least_ = least + lateness;
        window_begin_ = arrival;
    }
    least_ = std::min(least_, least + lateness);
    return arrival - (least + lateness - std::min(least_before_, least_));
}

void LidarClock::set(double offset, double arrival) noexcept {
    is_set_ = true;
    least_before_ = least_ = offset;
    window_begin_ = arrival;
}

void TurnClock::begin_turn(double arrival) {
    constexpr double kPeriodMax = 1.0; // seconds; no lidar turns more slowly
    if (!arrivals_.empty()) {
        const double elapsed = arrival - arrivals_.back();
        const double expected = period().value_or(elapsed);
        if (elapsed < 0.5 * expected || elapsed > 1.5 * expected || elapsed > kPeriodMax) arrivals_.clear();
    }
    arrivals_.push_back(arrival);
    if (arrivals_.size() > kTurnsUsed) arrivals_.pop_front();
}

double TurnClock::begun() const {
    const double turn = period().value_or(0.0);
    double begun = arrivals_.back();
    double ahead = 0.0; // seconds from a turn to the newest one
    for (auto arrival = arrivals_.rbegin(); arrival != arrivals_.rend(); ++arrival, ahead += turn) {
        begun = std::min(begun, *arrival + ahead);
    }
    return begun;
}

std::optional<double> TurnClock::period() const {
    if (arrivals_.size() < 2) return std::nullopt;
    const double turn = (arrivals_.back() - arrivals_.front()) / static_cast<double>(arrivals_.size() - 1);
    return turn > 0.0 ? std::optional(turn) : std::nullopt;
}

} // namespace scanloom::robot
