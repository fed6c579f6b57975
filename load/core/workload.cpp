#include "load/core/workload.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::load {

Schedule::Schedule(std::uint32_t robots, double rate)
    : robots_(robots), step_(static_cast<double>(kSecond) / (rate * static_cast<double>(robots))) {
    assert(robots > 0 && rate > 0.0);
}

std::uint64_t Schedule::scans_within(double duration_s, double rate) noexcept {
    const double scans = std::ceil(duration_s * rate - 1e-6); // 0.3 s at 10 Hz are three, despite rounding errors
    return static_cast<std::uint64_t>(std::max(scans, 1.0));
}

Workload make_workload(const Sensor& sensor, const std::vector<Scan>& scans, double stamp_rate, std::uint32_t batch) {
    assert(!scans.empty() && batch > 0 && stamp_rate > 0.0);
    Workload workload;
    workload.scans.reserve(scans.size());
    for (const Scan& scan : scans) workload.scans.emplace_back(scan);
    workload.beams = scans.front().ranges.size();
    workload.sensor = std::make_shared<const Sensor>(sensor);
    workload.stamp_rate = stamp_rate;
    workload.batch = batch;
    return workload;
}

wire::NumberedScan scan_at(const Workload& workload, std::size_t first, std::uint64_t seq) noexcept {
    const std::uint64_t last = workload.scans.size() - 1;
    const std::uint64_t way = last == 0 ? 0 : (first + seq - 1) % (2 * last);
    return {&workload.scans[way <= last ? way : 2 * last - way], seq,
            static_cast<double>(seq - 1) / workload.stamp_rate};
}

} // namespace scanloom::load
