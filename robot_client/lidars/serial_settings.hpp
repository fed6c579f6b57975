#pragma once

#include <optional>

namespace scanloom::robot {

/// How a serial device is set; without meaning over TCP.
struct SerialSettings {
    unsigned baud = 0;       ///< any rate that the device can be set to
    std::optional<bool> dtr; ///< level of the line DTR, which controls the motor of some lidars; nullopt: left as it is
};

} // namespace scanloom::robot
