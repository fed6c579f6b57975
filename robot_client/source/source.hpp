#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <memory>
#include <optional>

namespace scanloom::robot {

/// What a beam without a return tells the map: its way is free up to range_max, or nothing.
enum class NoReturn { kFree, kDrop };

/// A scan and the sensor that took it. Its seq is not set here: the uplink numbers scans.
struct Observation {
    std::shared_ptr<const Sensor> sensor;
    Scan scan;
};

/// Where scans come from, in the order in which they are sent.
///
/// Post    every scan and sensor keeps common/scan/limits.hpp: the server will not refuse it.
/// Thread  one at a time.
class Source {
public:
    virtual ~Source() = default;

    /// The next scan; nothing when the source has ended.
    [[nodiscard]] virtual std::optional<Observation> next() = 0;

    /// Called once, before next(): the server already holds `seq` scans of this robot.
    /// A recording continues behind them, a simulation begins anew and its scans are numbered from seq + 1.
    /// Errors  kConflict: the recording has fewer scans than that.
    [[nodiscard]] virtual Result<> resume_after(std::uint64_t seq) = 0;

    /// Scans this source will have given in the end, those skipped included; nothing where it cannot know.
    [[nodiscard]] virtual std::optional<std::uint64_t> scan_count() const = 0;
};

} // namespace scanloom::robot
