#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

/// Compute when a lidar that is read live has measured.
namespace scanloom::robot {

/// Returns the present Unix time, in seconds.
[[nodiscard]] double unix_now();

/// Clock of a sensor that states milliseconds which wrap: Unix time. Bytes arrive late by some milliseconds, which
/// vary. The sensor's own clock has no jitter, but it has no fixed origin and drifts. So a packet gets its time by the
/// sensor's clock, set by the packet of the last ten seconds that arrived with the least delay. The time of arrival
/// also determines the number of wraps, so any number of packets may have been lost.
class LidarClock {
public:
    /// @param wrap  milliseconds after which the sensor's clock restarts at 0
    explicit LidarClock(std::uint32_t wrap) : wrap_(static_cast<double>(wrap) * 1e-3) {}

    /// Returns the stamp of the next packet.
    /// @param milliseconds  that the packet states
    /// @param arrival       Unix seconds
    [[nodiscard]] double stamp(std::uint32_t milliseconds, double arrival);

    /// Resets the clock for another sensor, or for the same one after a restart.
    void restart() noexcept { is_set_ = false; }

private:
    void set(double offset, double arrival) noexcept;

    double wrap_; ///< seconds
    // Offsets are Unix time minus the sensor's time, in seconds. They differ by less than half a wrap.
    bool is_set_ = false;
    double least_before_ = 0.0; ///< within the previous window
    double least_ = 0.0;        ///< within the current window
    double window_begin_ = 0.0; ///< Unix seconds
};

/// Clock of a sensor that states no time but marks where its turns begin. The sensor turns evenly, and its bytes arrive
/// late by some milliseconds, which vary: a turn begins when the least delayed of the last turns says so.
class TurnClock {
public:
    /// Adds the beginning of a turn. If it does not fit the turns before it, because a mark was lost or the sensor
    /// changed its speed by more than a half, the clock starts with this turn.
    /// @param arrival  Unix seconds, of the mark
    void begin_turn(double arrival);

    /// Returns when the newest turn began, Unix seconds. Pre: a turn has begun.
    [[nodiscard]] double begun() const;
    /// Returns the seconds of a turn, or nullopt if they are not known.
    [[nodiscard]] std::optional<double> period() const;

    /// Resets the clock.
    void restart() noexcept { arrivals_.clear(); }

private:
    static constexpr std::size_t kTurnsUsed = 8;

    std::deque<double> arrivals_; ///< of the marks of the last turns, Unix seconds
};

} // namespace scanloom::robot
