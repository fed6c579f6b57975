#pragma once

#include <cstdint>
#include <limits>
#include <optional>

/// When packets were taken, by the milliseconds they carry, which wrap every 30 s.
namespace scanloom::robot {

/// Of a recording: seconds since its first packet. Packets may be missing for less than 15 s. Time never goes back:
/// where the milliseconds do (another recording was put behind, or the sensor was started again) it stands still.
class Ld06RecordingClock {
public:
    /// Of the next packet.
    [[nodiscard]] double stamp(std::uint16_t milliseconds);

private:
    std::optional<std::uint16_t> last_;
    std::uint64_t elapsed_ = 0; // milliseconds
};

/// Of a sensor that is read now: Unix time. Bytes arrive late by some milliseconds, which vary; the sensor's own clock
/// does not jitter, but has no beginning and drifts. So a packet was taken at its own time by the sensor's clock, set
/// by that packet of the last ten seconds that came through fastest. The time of arrival also tells which wrap it is,
/// so that any number of packets may have been lost.
class Ld06LiveClock {
public:
    /// Of the next packet, which arrived at `arrival`, Unix seconds.
    [[nodiscard]] double stamp(std::uint16_t milliseconds, double arrival);

    /// Another sensor, or the same one started again.
    void restart() noexcept { is_set_ = false; }

private:
    void set(double offset, double arrival) noexcept;

    // Offsets are Unix time less the sensor's, seconds, and differ from each other by less than half a wrap.
    bool is_set_ = false;
    double least_before_ = 0.0; ///< within the window before
    double least_ = 0.0;        ///< within the current window
    double window_begin_ = 0.0; ///< Unix seconds
};

} // namespace scanloom::robot
