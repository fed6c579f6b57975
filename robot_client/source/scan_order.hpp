#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::robot {

/// Stamps that go back by no more than this jitter; a log whose stamps go back by more holds parts out of their place.
inline constexpr double kStampJitterMax = 2.0; // seconds

/// The order in which the scans of a log are sent.
struct ScanOrder {
    std::vector<std::uint32_t> order; ///< indices of the scans
    std::size_t steps_back = 0;       ///< scans whose stamp is less than that of the one before in the file
    double back_max = 0.0;            ///< the farthest that a stamp lies behind the newest before it, seconds
    bool is_of_file = true;
    bool is_of_stamps = true; ///< no stamp goes back in this order
};

/// Scans keep the order of the file where their stamps only jitter: it is the order in which they were taken, and
/// sorting would make the robot jump to and fro. Where a stamp lies behind the newest before it by more than
/// kStampJitterMax, a part begins that is out of its place: the parts are then ordered by time (stably), and within
/// each part jitter still changes nothing.
/// Pre  stamps are finite, fewer than 2^32.
[[nodiscard]] ScanOrder order_of(std::span<const double> stamps);

} // namespace scanloom::robot
