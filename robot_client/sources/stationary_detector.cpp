#include "robot_client/sources/stationary_detector.hpp"

#include "common/scan/reading.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr std::int32_t kGapsMax = 4; // as on the server: wider gaps were not observed

bool is_return(RangeMm range) { return range != kInvalidRange && range != kNoReturn; }

/// Returns the steps from each beam to the next, around the turn.
std::vector<std::int32_t> gaps_between(std::span<const std::int32_t> steps, std::int32_t steps_per_turn) {
    std::vector<std::int32_t> gaps(steps.size());
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) gaps[i] = steps[i + 1] - steps[i];
    gaps.back() = steps.front() + steps_per_turn - steps.back();
    return gaps;
}

/// Returns the middle value; changes the order. Pre: there is one.
template <class Number>
Number median_of(std::span<Number> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace

std::vector<RangeMm> median_filtered(std::span<const RangeMm> ranges, std::span<const std::int32_t> steps,
                                     std::int32_t steps_per_turn, int window) {
    assert(window % 2 == 1 && window >= 1 && window <= kMedianWindowMax);
    assert(ranges.size() == steps.size());
    std::vector<RangeMm> filtered(ranges.begin(), ranges.end());
    const std::size_t count = ranges.size();
    if (count < static_cast<std::size_t>(window)) return filtered;
    const auto gaps = gaps_between(steps, steps_per_turn);
    auto sorted = gaps;
    const std::int32_t gap_max = kGapsMax * median_of(std::span(sorted));
    /// Returns whether beam `i` and the next one are adjacent returns.
    const auto goes_on = [&](std::size_t i) {
        return is_return(ranges[i]) && is_return(ranges[(i + 1) % count]) && gaps[i] <= gap_max;
    };
    std::array<RangeMm, kMedianWindowMax> values;
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t reach = 0;
        const auto half = static_cast<std::size_t>(window / 2);
        while (reach < half && goes_on((i + reach) % count) && goes_on((i + count - reach - 1) % count)) ++reach;
        const std::size_t size = 2 * reach + 1;
        for (std::size_t k = 0; k < size; ++k) values[k] = ranges[(i + count - reach + k) % count];
        filtered[i] = median_of(std::span(values).first(size));
    }
    return filtered;
}

namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kTolerance = 0.03;      // metres, plus
constexpr double kTolerancePart = 0.005; // of the range

/// A turn that shows fewer directions cannot be judged.
constexpr std::size_t kDirectionsMin = kDirections / 10;

/// Smallest share of the comparable directions. In a real recording, the least among turns cut by a gap is 0.23.
constexpr double kComparedPartMin = 0.2;

double median_or_nothing(std::vector<double>& values) {
    return values.empty() ? kNothing : median_of(std::span(values));
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
        medians[direction] = 2 * values.size() >= turns.size() ? median_or_nothing(values) : kNothing;
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
    std::ranges::transform(met, profile.begin(), median_or_nothing);
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
