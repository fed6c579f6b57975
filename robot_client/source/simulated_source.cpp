#include "robot_client/source/simulated_source.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {

std::uint64_t scans_within(double duration, std::size_t sensors) {
    const double moments =
        std::ceil(duration / kScanPeriod - 1e-6); // 0.3 s are three periods of 0.1 s despite rounding
    const double scans = moments * static_cast<double>(sensors);
    return scans < 1e15 ? static_cast<std::uint64_t>(scans) : std::numeric_limits<std::uint64_t>::max();
}

Observation observed(Simulator& simulator, NoReturn no_return) {
    Observation observation{nullptr, simulator.next_scan()};
    observation.sensor = simulator.sensor_of(observation.scan);
    if (no_return == NoReturn::kDrop) {
        auto& ranges = observation.scan.ranges;
        std::replace(ranges.begin(), ranges.end(), kNoReturn, kInvalidRange);
    }
    return observation;
}

SimulatedSource::SimulatedSource(Simulator simulator, SimulationLimits limits, NoReturn no_return)
    : simulator_(std::move(simulator)), limits_(limits), no_return_(no_return) {
    limits_.scans = std::min(limits_.scans, scans_within(limits_.duration, simulator_.sensors().size()));
}

Result<std::optional<Observation>> SimulatedSource::next() {
    if (scans_ == limits_.scans || is_done()) return std::optional<Observation>{};
    ++scans_;
    return std::optional(observed(simulator_, no_return_));
}

std::optional<std::uint64_t> SimulatedSource::scan_count() const {
    if (is_done() || scans_ == limits_.scans) return scans_;
    if (simulator_.behaviour().has_an_end()) return std::nullopt;
    if (limits_.scans == std::numeric_limits<std::uint64_t>::max()) return std::nullopt;
    return limits_.scans;
}

} // namespace scanloom::robot
