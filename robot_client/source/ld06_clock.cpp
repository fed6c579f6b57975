#include "robot_client/source/ld06_clock.hpp"

#include "robot_client/source/ld06_packet.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {
namespace {

constexpr double kWrap = kLd06ClockWrap * 1e-3; // seconds
constexpr double kWindow = 5.0;                 // seconds; the last two windows are used

/// No packet arrives later than this. If one seems to, one of the two clocks was set.
constexpr double kLateMax = 1.0; // seconds

} // namespace

double Ld06RecordingClock::stamp(std::uint16_t milliseconds) {
    const int forward = (milliseconds - last_.value_or(milliseconds) + 2 * kLd06ClockWrap) % kLd06ClockWrap;
    if (forward < kLd06ClockWrap / 2) elapsed_ += static_cast<unsigned>(forward);
    last_ = milliseconds;
    return static_cast<double>(elapsed_) * 1e-3;
}

double Ld06LiveClock::stamp(std::uint16_t milliseconds, double arrival) {
    const double offset = arrival - milliseconds * 1e-3;
    if (!is_set_) set(offset, arrival);
    const double least = std::min(least_before_, least_);
    const double lateness = std::remainder(offset - least, kWrap);
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

void Ld06LiveClock::set(double offset, double arrival) noexcept {
    is_set_ = true;
    least_before_ = least_ = offset;
    window_begin_ = arrival;
}

} // namespace scanloom::robot
