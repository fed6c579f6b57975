#pragma once

#include "robot_client/sources/source.hpp"
#include "sim/simulator.hpp"

#include <limits>
#include <string>
#include <string_view>

namespace scanloom::sim {

/// Returns at most 64 printable bytes that identify the scans of a simulated robot. They are the same if the world (for
/// a map, its cells), the drive, the sensors, the noise, the seed, the pose that is sent, what the poses are and the
/// use of beams without a return are the same.
[[nodiscard]] std::string fingerprint_of(const SimulatorOptions& options, std::string_view drive,
                                         robot::NoReturn no_return);

struct SimulationLimits {
    double duration = std::numeric_limits<double>::infinity();       ///< seconds of simulated time
    std::uint64_t scans = std::numeric_limits<std::uint64_t>::max(); ///< of all sensors
};

/// Returns how many scans `sensors` sensors take at 0, p, 2 p, ... before `duration` seconds have passed.
[[nodiscard]] std::uint64_t scans_within(double duration, std::size_t sensors);

/// Takes the next scan of a simulated robot.
[[nodiscard]] robot::Observation observed(Simulator& simulator, robot::NoReturn no_return);

/// A simulated robot as a source. It ends at the first of its limits, when its behaviour is done, or never.
class SimulatedSource final : public robot::Source {
public:
    SimulatedSource(Simulator simulator, SimulationLimits limits, robot::NoReturn no_return);

    [[nodiscard]] Result<std::optional<robot::Observation>> next() override;
    /// Returns nullopt until the end if the behaviour can end.
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override;
    [[nodiscard]] std::string remarks() const override { return simulator_.behaviour().remarks(); }

private:
    [[nodiscard]] bool is_done() const { return scans_ > 0 && simulator_.behaviour().is_done(); }

    Simulator simulator_;
    SimulationLimits limits_;
    robot::NoReturn no_return_;
    std::uint64_t scans_ = 0;
};

} // namespace scanloom::sim
