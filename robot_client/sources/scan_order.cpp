#include "robot_client/sources/scan_order.hpp"

#include <algorithm>
#include <numeric>

namespace scanloom::robot {

ScanOrder order_of(std::span<const double> stamps) {
    ScanOrder result;
    result.order.resize(stamps.size());
    std::iota(result.order.begin(), result.order.end(), 0U);

    std::vector<double> newest(stamps.begin(), stamps.end()); // newest stamp of each scan's part, up to that scan
    for (std::size_t i = 1; i < stamps.size(); ++i) {
        if (stamps[i] < stamps[i - 1]) ++result.steps_back;
        const double back = newest[i - 1] - stamps[i];
        result.back_max = std::max(result.back_max, back);
        if (back > kStampJitterMax) result.file_order = false;
        if (back <= kStampJitterMax) newest[i] = std::max(newest[i - 1], stamps[i]);
    }
    std::ranges::stable_sort(result.order, {}, [&](std::uint32_t i) { return newest[i]; });
    result.is_of_stamps = std::ranges::is_sorted(result.order, {}, [&](std::uint32_t i) { return stamps[i]; });
    return result;
}

} // namespace scanloom::robot
