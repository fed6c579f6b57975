#include "robot_client/sources/ld06_turns.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/sources/messages.hpp"
#include "robot_client/sources/stationary_detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

void Ld06Turns::add_point(Ld06Beam beam, const Ld06Packet& packet, double stamp) {
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

std::optional<Ld06Turn> Ld06Turns::next() {
    if (complete_.empty()) return std::nullopt;
    Ld06Turn turn = std::move(complete_.front());
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

std::string ld06_remarks(const Ld06Counts& counts, const Ld06Turns& turns, const Ld06Losses& losses) {
    std::string text = fmt::format("{}, {}", counted(counts.crc_failures + counts.implausible, "damaged packet"),
                                   counted(turns.count(), "turn"));
    if (turns.gaps() > 0) {
        text += fmt::format(", {} of them cut by {}", turns.parts(), counted(turns.gaps(), "gap"));
    }
    const auto add = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
        if (count > 0) text += fmt::format(", {} {}", counted(count, noun), what);
    };
    add(turns.too_long(), "turn", "too slow");
    add(losses.without_pose, "scan", "skipped without a pose");
    add(losses.too_many_waiting, "scan", "dropped by the buffer");
    return text;
}

namespace {

constexpr double kRadiansPerStep = 2.0 * std::numbers::pi / kLd06StepsPerTurn;

/// Only for the description: every scan contains its own angles.
constexpr std::uint32_t kUsualBeams = 450;

class ReadingFilter {
public:
    explicit ReadingFilter(const Ld06ScanOptions& options)
        : confidence_min_(options.confidence_min), min_(to_range_mm(options.range_min)),
          max_(to_range_mm(options.range_max)),
          no_return_(options.no_return == NoReturn::kFree ? kNoReturn : kInvalidRange) {}

    [[nodiscard]] RangeMm operator()(const Ld06Point& point) const {
        static_assert(kInvalidRange == 0, "a distance of 0 is none, whatever the least range is");
        if (point.distance < min_ || point.confidence < confidence_min_) return kInvalidRange;
        return point.distance < max_ ? point.distance : no_return_;
    }

private:
    std::uint8_t confidence_min_;
    RangeMm min_;
    RangeMm max_;
    RangeMm no_return_;
};

} // namespace

std::shared_ptr<const Sensor> ld06_sensor(const Ld06ScanOptions& options) {
    const UniformAngles angles{0.0, 2.0 * std::numbers::pi / kUsualBeams, kUsualBeams};
    return std::make_shared<const Sensor>(Sensor{.id = 0,
                                                 .kind = SensorKind::kLaser,
                                                 .name = "LD06",
                                                 .mount = options.mount,
                                                 .angles = angles,
                                                 .aperture = 0.0,
                                                 .range_min = options.range_min,
                                                 .range_max = options.range_max});
}

Scan ld06_scan(const Ld06Turn& turn, const Ld06ScanOptions& options) {
    const ReadingFilter filter(options);
    Scan scan;
    scan.stamp = turn.stamp;
    // The sensor turns clockwise, so the first beam was taken last.
    if (std::abs(turn.duration) <= kDurationMax) scan.duration = 0.0 - turn.duration;
    SteppedAngles angles{kRadiansPerStep, {}};
    for (auto beam = turn.beams.rbegin(); beam != turn.beams.rend(); ++beam) {
        angles.steps.push_back(kLd06StepsPerTurn - beam->step);
        scan.ranges.push_back(filter(beam->point));
        scan.intensities.push_back(beam->point.confidence);
    }
    if (options.median_window) {
        scan.ranges = median_filtered(scan.ranges, angles.steps, kLd06StepsPerTurn, *options.median_window);
    }
    scan.angles = std::move(angles);
    return scan;
}

} // namespace scanloom::robot
