#include "robot_client/sources/scan_order.hpp"

#include <algorithm>
#include <numeric>

namespace scanloom::robot {
namespace {

/// Consecutive scans of a log whose stamps only jitter.
struct LogPart {
    std::uint32_t begin = 0; // index of its first scan
    std::uint32_t end = 0;   // index after its last scan
    double oldest = 0.0;     // seconds
    double newest = 0.0;     // seconds
};

/// Divides the log, and sets what the stamps show about their order.
std::vector<LogPart> parts_of(std::span<const double> stamps, StampReport& report) {
    std::vector<LogPart> parts;
    for (std::uint32_t i = 0; i < stamps.size(); ++i) {
        const double stamp = stamps[i];
        if (i > 0 && stamp < stamps[i - 1]) ++report.steps_back;
        const double back = parts.empty() ? 0.0 : parts.back().newest - stamp;
        report.back_max = std::max(report.back_max, back);
        if (parts.empty() || back > kStampJitterMax) parts.push_back({i, i, stamp, stamp});
        LogPart& part = parts.back();
        part.end = i + 1;
        part.oldest = std::min(part.oldest, stamp);
        part.newest = std::max(part.newest, stamp);
    }
    return parts;
}

/// Returns whether each part ends before the next one begins, apart from jitter.
bool follow_each_other(std::span<const LogPart> parts) {
    const auto overlap = [](const LogPart& earlier, const LogPart& later) {
        return later.newest < earlier.newest || earlier.newest - later.oldest > kStampJitterMax;
    };
    return std::ranges::adjacent_find(parts, overlap) == parts.end();
}

} // namespace

ScanOrder order_of(std::span<const double> stamps) {
    ScanOrder result;
    auto parts = parts_of(stamps, result);
    result.order.resize(stamps.size());
    std::iota(result.order.begin(), result.order.end(), 0U);
    if (parts.size() > 1) {
        std::ranges::stable_sort(parts, {}, &LogPart::oldest);
        result.file_order = result.is_clock_set_back = !follow_each_other(parts);
    }
    if (!result.file_order) {
        result.order.clear();
        for (const LogPart& part : parts) {
            for (std::uint32_t i = part.begin; i < part.end; ++i) result.order.push_back(i);
        }
    }
    result.is_of_stamps = std::ranges::is_sorted(result.order, {}, [&](std::uint32_t i) { return stamps[i]; });
    return result;
}

} // namespace scanloom::robot
