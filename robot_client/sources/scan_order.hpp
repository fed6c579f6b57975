#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::robot {

/// Stamps that go back by at most this are jitter. A log whose stamps go back by more has parts out of order.
inline constexpr double kStampJitterMax = 2.0; // seconds

/// What the stamps of a log's scans show about their order.
struct StampReport {
    std::size_t steps_back = 0; ///< scans with a smaller stamp than the scan before in the file
    double back_max = 0.0;      ///< the farthest that a stamp lies behind the newest one before it, seconds
    bool file_order = true;     ///< whether scans are sent in the order of the file; otherwise by time
};

/// The order in which the scans of a log are sent.
struct ScanOrder : StampReport {
    std::vector<std::uint32_t> order; ///< indices of the scans
    bool is_of_stamps = true;         ///< whether no stamp goes back in this order
};

/// Computes the order of a log's scans. Scans keep the order of the file if their stamps only jitter: that is the order
/// in which they were taken, and sorting would make the robot jump back and forth. Where a stamp lies more than
/// kStampJitterMax behind the newest one before it, a new part begins. The parts are then ordered by time (stable);
/// within each part, jitter still changes nothing.
/// Pre: stamps are finite, fewer than 2^32.
[[nodiscard]] ScanOrder order_of(std::span<const double> stamps);

} // namespace scanloom::robot
