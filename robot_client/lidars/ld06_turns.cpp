#include "robot_client/lidars/ld06_turns.hpp"

#include "common/scan/limits.hpp"

#include <cmath>

namespace scanloom::robot {
double Ld06RecordingClock::stamp(std::uint16_t milliseconds) {
    const int forward = (milliseconds - last_.value_or(milliseconds) + 2 * kLd06ClockWrap) % kLd06ClockWrap;
    if (forward < kLd06ClockWrap / 2) elapsed_ += static_cast<unsigned>(forward);
    last_ = milliseconds;
    return static_cast<double>(elapsed_) * 1e-3;
}

namespace {

/// How much angle and time may differ: the time is in whole milliseconds (3.6 degrees at 10 turns per second), the
/// speed changes while the sensor starts, and some packets are sent out of place by a few degrees.
constexpr std::int32_t kDisagreementMax = 20 * kLd06StepsPerDegree;

} // namespace

void Ld06Turns::add(const Ld06Packet& packet, double stamp) {
    const auto followed = before_ ? follow(packet) : std::nullopt;
    if (before_ && !followed) {
        ++gaps_;
        is_part_ = true;
        end_turn();
        is_given_ = true;
        is_part_ = true;
    }
    const std::int32_t span = steps_spanned(packet);
    std::int32_t start = followed.value_or(packet.start_angle * kLd06StepsPerDegree / 100 % kLd06StepsPerTurn);
    for (std::size_t i = 0; i < packet.points.size(); ++i) {
        const auto gaps = static_cast<std::int32_t>(kLd06PacketPoints - 1);
        std::int32_t step = start + span / gaps * static_cast<std::int32_t>(i);
        while (step >= kLd06StepsPerTurn) {
            end_turn();
            is_given_ = true;
            start -= kLd06StepsPerTurn;
            step -= kLd06StepsPerTurn;
        }
        add_point({step, packet.points[i]}, packet, stamp);
    }
    before_ = Before{start, packet.timestamp};
}

/// Returns where the packet starts, in steps of the current turn, or nullopt if that cannot be determined.
std::optional<std::int32_t> Ld06Turns::follow(const Ld06Packet& packet) const {
    const int elapsed = (packet.timestamp - before_->timestamp + 2 * kLd06ClockWrap) % kLd06ClockWrap;
    const std::int64_t expected = std::int64_t{elapsed} * packet.speed * kLd06StepsPerDegree / 1000;
    if (elapsed >= kLd06ClockWrap / 2 || expected >= kLd06StepsPerTurn) return std::nullopt;
    const auto start = packet.start_angle * kLd06StepsPerDegree / 100;
    const double disagreement =
        std::remainder(static_cast<double>(start - before_->start - expected), static_cast<double>(kLd06StepsPerTurn));
    if (std::abs(disagreement) > kDisagreementMax) return std::nullopt;
    return before_->start + static_cast<std::int32_t>(expected) + static_cast<std::int32_t>(disagreement);
}

void Ld06Turns::add_point(LidarBeam beam, const Ld06Packet& packet, double stamp) {
    if (beam.step < 0 || (!beams_.empty() && beam.step <= beams_.back().step)) return;
    if (beams_.empty()) first_stamp_ = stamp;
    last_stamp_ = stamp;
    if (beams_.size() > kBeamsMax) return; // one point too many shows that the turn is too long
    beams_.push_back(beam);
    speeds_ += packet.speed;
}

/// Returns the seconds from the first point of the turn to the last. The packets' times are whole milliseconds, and
/// those of packets, not of points.
double Ld06Turns::duration() const {
    const double speed = static_cast<double>(speeds_) / static_cast<double>(beams_.size()); // degrees per second
    const double degrees = static_cast<double>(beams_.back().step - beams_.front().step) / kLd06StepsPerDegree;
    return speed > 0.0 ? degrees / speed : 0.0;
}

void Ld06Turns::end_turn() {
    if (beams_.size() > kBeamsMax) {
        ++too_long_;
    } else if (is_given_ && !beams_.empty()) {
        const double seconds = duration();
        complete_.push_back({(first_stamp_ + last_stamp_) / 2.0, std::move(beams_), seconds});
        ++count_;
        parts_ += is_part_ ? 1 : 0;
    }
    beams_.clear();
    speeds_ = 0;
    is_part_ = false;
}

std::optional<LidarTurn> Ld06Turns::next() {
    if (complete_.empty()) return std::nullopt;
    LidarTurn turn = std::move(complete_.front());
    complete_.pop_front();
    return turn;
}

void Ld06Turns::restart() {
    before_.reset();
    is_given_ = false;
    is_part_ = false;
    beams_.clear();
    speeds_ = 0;
}

LidarCounts ld06_counts(const Ld06Counts& packets, const Ld06Turns& turns) noexcept {
    return {.damaged = packets.crc_failures + packets.implausible,
            .turns = turns.count(),
            .parts = turns.parts(),
            .gaps = turns.gaps(),
            .too_long = turns.too_long()};
}

std::shared_ptr<const Sensor> ld06_sensor(const LidarScanOptions& options) {
    constexpr std::uint32_t kUsualBeams = 450;
    return lidar_sensor("LD06", kUsualBeams, options);
}

Scan ld06_scan(const LidarTurn& turn, const LidarScanOptions& options) {
    return lidar_scan(turn, kLd06StepsPerTurn, options);
}

} // namespace scanloom::robot
