#include "robot_client/source/stationary_detector.hpp"

#include "common/scan/reading.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kTolerance = 0.03;      // metres, plus
constexpr double kTolerancePart = 0.005; // of the range

/// A turn that shows fewer directions cannot be judged.
constexpr std::size_t kDirectionsMin = kDirections / 10;

/// Smallest share of the comparable directions. In a real recording, the least among turns cut by a gap is 0.23.
constexpr double kComparedPartMin = 0.2;

/// Returns NaN for no values. Changes the order of `values`.
double median_of(std::vector<double>& values) {
    if (values.empty()) return kNothing;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::size_t direction_of(double angle_rad) {
    const double turns = angle_rad / (2.0 * std::numbers::pi);
    const double degrees = (turns - std::floor(turns)) * static_cast<double>(kDirections);
    return std::min(static_cast<std::size_t>(degrees), kDirections - 1); // rounding may give a full turn
}

std::size_t shown_by(const TurnProfile& turn) {
    return static_cast<std::size_t>(std::ranges::count_if(turn, [](double range) { return !std::isnan(range); }));
}

/// Returns the median of each direction over the turns, if at least half of them have a return there.
TurnProfile medians_of(const std::vector<TurnProfile>& turns) {
    TurnProfile medians;
    std::vector<double> values;
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
        values.clear();
        for (const TurnProfile& turn : turns) {
            if (!std::isnan(turn[direction])) values.push_back(turn[direction]);
        }
        medians[direction] = 2 * values.size() >= turns.size() ? median_of(values) : kNothing;
    }
    return medians;
}

} // namespace

TurnProfile profile_of(const Scan& scan, const Sensor& sensor) {
    const BeamAngles angles = angles_of(scan, sensor);
    const ReadingRules rules{sensor.range_min, sensor.range_max, true};
    std::array<std::vector<double>, kDirections> met;
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
        const auto reading = reading_of(scan.ranges[beam], rules);
        if (reading && reading->is_hit) met[direction_of(beam_angle(angles, beam))].push_back(reading->metres);
    }
    TurnProfile profile;
    std::ranges::transform(met, profile.begin(), [](std::vector<double>& ranges) { return median_of(ranges); });
    return profile;
}

void StationaryDetector::learn(const TurnProfile& turn) {
    assert(learnt_.size() < kTurnsMax);
    learnt_.push_back(turn);
    const TurnProfile medians = medians_of(learnt_);
    comparable_ = 0;
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
        low_[direction] = high_[direction] = medians[direction];
        if (std::isnan(medians[direction])) continue;
        ++comparable_;
        for (const std::size_t neighbour : {direction + 1, direction + kDirections - 1}) {
            const double range = medians[neighbour % kDirections];
            low_[direction] = std::fmin(low_[direction], range); // fmin and fmax ignore NaN
            high_[direction] = std::fmax(high_[direction], range);
        }
        const double tolerance = kTolerance + kTolerancePart * medians[direction];
        low_[direction] -= tolerance;
        high_[direction] += tolerance;
    }
}

std::optional<double> StationaryDetector::changed_part(const TurnProfile& turn) const {
    std::size_t compared = 0;
    std::size_t changed = 0;
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
        const double range = turn[direction];
        if (std::isnan(range) || std::isnan(low_[direction])) continue;
        ++compared;
        changed += range < low_[direction] || range > high_[direction] ? 1 : 0;
    }
    if (compared == 0 || static_cast<double>(compared) < kComparedPartMin * static_cast<double>(comparable_)) {
        return std::nullopt;
    }
    return static_cast<double>(changed) / static_cast<double>(compared);
}

StationaryDetector::Verdict StationaryDetector::judge(const TurnProfile& turn) const {
    if (learnt_.empty()) return shown_by(turn) < kDirectionsMin ? Verdict::kUnclear : Verdict::kStill;
    const auto changed = changed_part(turn);
    if (!changed) return Verdict::kUnclear;
    const double part_max = learnt_.size() < kTurnsMax ? kLearningPartMax : kChangedPartMax;
    return *changed <= part_max ? Verdict::kStill : Verdict::kMoved;
}

} // namespace scanloom::robot
