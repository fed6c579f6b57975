#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::robot {

inline constexpr std::size_t kDirections = 360;

/// What one turn of a sensor shows in each direction of its own, each a degree wide: the median of what it met there,
/// in metres; NaN where it met nothing.
using TurnProfile = std::array<double, kDirections>;

/// Pre  the sensor took the scan; its angles have one entry per range.
[[nodiscard]] TurnProfile profile_of(const Scan& scan, const Sensor& sensor);

/// Tells from ranges alone whether a sensor stands where it stood when it took the turns that were learnt.
///
/// A turn is compared with their medians, direction by direction. Where it lies outside the span of the same direction
/// and its two neighbours (the beams of a spinning sensor point elsewhere turn by turn) by more than 3 cm and 0.5 % of
/// the range, that direction has changed. People who walk by change some directions, a move changes many.
///
/// Measured, as the part of the directions that changed:
///                              stands       a person at 0.5 m, 0.8 m   moved 10 cm        turned 5 (3) degrees
///   a real LD06 in a room      up to 0.02                              0.38 and more      0.53 (0.33) and more
///   simulated, room, office    up to 0.08   up to 0.24, 0.17           19 of 20 over 0.34 0.41 (0.27) and more
/// The real sensor stood; the points of its turns were moved and turned instead. The simulated one has 360 beams, each
/// with a sigma of 0.02 m and 0.005 rad. Along a corridor without corners, and in a hall most of which is out of its
/// sight, a move shows later.
///
/// Thread  one at a time.
class Stillness {
public:
    static constexpr std::size_t kTurnsMax = 10;
    static constexpr double kChangedPartMax = 0.27;
    /// As long as it learns, so that a sensor that is being put down is not taken for one that stands: four of five
    /// moves by 5 cm change more, in both rows above.
    static constexpr double kLearningPartMax = 0.15;

    enum class Verdict {
        kStill,
        kMoved,
        kUnclear, ///< too few directions can be compared: a part of a turn, a sensor that is covered
    };

    /// Of a turn, against those learnt. The first one is still, if it shows enough.
    [[nodiscard]] Verdict judge(const TurnProfile& turn) const;

    /// The part of the directions compared that have changed; nothing where they are too few.
    [[nodiscard]] std::optional<double> changed_part(const TurnProfile& turn) const;

    /// The sensor stood where it stands now when it took this turn. Pre  fewer than kTurnsMax were learnt.
    void learn(const TurnProfile& turn);

    [[nodiscard]] std::size_t turns() const noexcept { return learnt_.size(); }

private:
    std::vector<TurnProfile> learnt_;
    TurnProfile low_{}; ///< the span of each direction, metres; NaN: nothing to compare with
    TurnProfile high_{};
    std::size_t comparable_ = 0; ///< directions
};

} // namespace scanloom::robot
