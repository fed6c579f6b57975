#pragma once

#include "robot_client/sim/simulator.hpp"
#include "robot_client/source/source.hpp"

#include <limits>

namespace scanloom::robot {

struct SimulationLimits {
    double duration = std::numeric_limits<double>::infinity();       ///< seconds of the simulation's time
    std::uint64_t scans = std::numeric_limits<std::uint64_t>::max(); ///< of all sensors
};

/// A simulated robot as a source; it ends at the first of its limits, or never.
class SimulatedSource final : public Source {
public:
    SimulatedSource(Simulator simulator, SimulationLimits limits, NoReturn no_return);

    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override;

private:
    Simulator simulator_;
    SimulationLimits limits_;
    NoReturn no_return_;
    std::uint64_t scans_ = 0;
};

} // namespace scanloom::robot
