#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

inline constexpr int kMedianWindowMin = 3;
inline constexpr int kMedianWindowMax = 101; ///< beams; 15 and more round corners, 51 and more remove them

/// Replaces each return by the median of itself and its neighbours, the same number on each side: half of `window`, or
/// fewer where the neighbours end, at a beam without a return and at a gap of more than four times the median gap. So
/// no beam becomes a return, no return is lost, and returns are not mixed across unobserved directions.
///
/// @param steps           direction of each beam, increasing, all within one turn; the last and the first beam are
///                        neighbours, too
/// @param steps_per_turn  steps of a full turn
/// @param window          beams; odd, from 1 (no change) to kMedianWindowMax
/// Pre: ranges.size() == steps.size().
[[nodiscard]] std::vector<RangeMm> median_filtered(std::span<const RangeMm> ranges, std::span<const std::int32_t> steps,
                                                   std::int32_t steps_per_turn, int window);

inline constexpr std::size_t kDirections = 360;

/// For each direction of the sensor, one degree wide: the median range of its returns in one turn, in metres; NaN
/// without returns.
using TurnProfile = std::array<double, kDirections>;

/// Computes the profile of one turn. Pre: the sensor took the scan; its angles have one entry per range.
[[nodiscard]] TurnProfile profile_of(const Scan& scan, const Sensor& sensor);

/// Stationary detection: decides from ranges alone whether a sensor is still where it was during the learned turns.
///
/// A turn is compared, direction by direction, with the medians of the learned turns. A direction has changed if its
/// range is outside the span of the medians of that direction and its two neighbours (the beams of a spinning sensor
/// point elsewhere in each turn) by more than 3 cm plus 0.5 % of the range. People who walk past change some
/// directions, a movement of the sensor changes many.
///
/// Measured share of the directions that changed:
///                              stands       a person at 0.5 m, 0.8 m   moved 10 cm        turned 5 (3) degrees
///   a real LD06 in a room      up to 0.02                              0.38 and more      0.53 (0.33) and more
///   simulated, room, office    up to 0.08   up to 0.24, 0.17           19 of 20 over 0.34 0.41 (0.27) and more
/// The real sensor was stationary; the points of its turns were shifted and rotated instead. The simulated one has 360
/// beams, each with a sigma of 0.02 m and 0.005 rad. Along a corridor without corners, and in a hall that is mostly
/// out of the sensor's range, a movement is detected later.
///
/// Threads: one at a time.
class StationaryDetector {
public:
    static constexpr std::size_t kTurnsMax = 10;
    static constexpr double kChangedPartMax = 0.27;
    /// Limit while turns are learned, so that a sensor that is just being put down does not count as stationary: four
    /// of five moves by 5 cm change more, in both rows above.
    static constexpr double kLearningPartMax = 0.15;

    enum class Verdict {
        kStill,
        kMoved,
        kUnclear, ///< too few directions can be compared: part of a turn, or a covered sensor
    };

    /// Compares a turn with those learned. The first turn is kStill if it shows enough.
    [[nodiscard]] Verdict judge(const TurnProfile& turn) const;

    /// Returns the share of the compared directions that have changed, or nullopt if too few can be compared.
    [[nodiscard]] std::optional<double> changed_part(const TurnProfile& turn) const;

    /// Adds a turn taken at the sensor's current place. Pre: fewer than kTurnsMax turns were learned.
    void learn(const TurnProfile& turn);

    [[nodiscard]] std::size_t turns() const noexcept { return learnt_.size(); }

private:
    std::vector<TurnProfile> learnt_;
    TurnProfile low_{}; ///< span of each direction, metres; NaN: nothing to compare with
    TurnProfile high_{};
    std::size_t comparable_ = 0; ///< directions
};

} // namespace scanloom::robot
