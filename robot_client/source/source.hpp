#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

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

    /// The next scan; nothing when the source has ended. A source that is made anew gives the same scans again: that
    /// is how a robot continues behind those the server has.
    /// Errors  a recording that cannot be read on.
    [[nodiscard]] virtual Result<std::optional<Observation>> next() = 0;

    /// Scans this source will have given in the end; nothing where it is endless, or that is not known.
    [[nodiscard]] virtual std::optional<std::uint64_t> scan_count() const = 0;

    /// What people should know of it beside its scans, a few words; empty: nothing.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::robot
