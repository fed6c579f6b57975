#pragma once

#include <cstdint>
#include <limits>
#include <optional>

/// Compute the time of packets from the milliseconds that they contain, which wrap every 30 s.
namespace scanloom::robot {

/// Clock of a recording: seconds since its first packet. Packets may be missing for less than 15 s. Time never goes
/// back: if the milliseconds do (another recording was appended, or the sensor was restarted), it stands still.
class Ld06RecordingClock {
public:
    /// Returns the stamp of the next packet.
    [[nodiscard]] double stamp(std::uint16_t milliseconds);

private:
    std::optional<std::uint16_t> last_;
    std::uint64_t elapsed_ = 0; // milliseconds
};

/// Clock of a sensor that is read live: Unix time. Bytes arrive late by some milliseconds, which vary. The sensor's own
/// clock has no jitter, but it has no fixed origin and drifts. So a packet gets its time by the sensor's clock, set by
/// the packet of the last ten seconds that arrived with the least delay. The time of arrival also determines the number
/// of wraps, so any number of packets may have been lost.
class Ld06LiveClock {
public:
    /// Returns the stamp of the next packet.
    /// @param arrival  Unix seconds
    [[nodiscard]] double stamp(std::uint16_t milliseconds, double arrival);

    /// Resets the clock for another sensor, or for the same one after a restart.
    void restart() noexcept { is_set_ = false; }

private:
    void set(double offset, double arrival) noexcept;

    // Offsets are Unix time minus the sensor's time, in seconds. They differ by less than half a wrap.
    bool is_set_ = false;
    double least_before_ = 0.0; ///< within the previous window
    double least_ = 0.0;        ///< within the current window
    double window_begin_ = 0.0; ///< Unix seconds
};

} // namespace scanloom::robot
