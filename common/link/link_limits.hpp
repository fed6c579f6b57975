#pragma once

#include "common/error/error.hpp"
#include "common/limits/token_bucket.hpp"
#include "common/scan/limits.hpp"
#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace scanloom::link {

/// The limits that a server applies to one robot's link.
struct LinkLimits {
    std::string token; ///< name of the token that has these limits, for messages
    double bytes_per_second = std::numeric_limits<double>::infinity(); ///< read from the link
    std::size_t sensors = kSensorsMax;                                 ///< of the robot
    std::size_t beams = kBeamsMax;                                     ///< of one scan
};

/// Checks what a robot sends against the limits of its link.
/// All times are in seconds of a monotonic clock.
class LimitCheck {
public:
    /// Creates a check without limits for a robot without sensors.
    explicit LimitCheck(double now) : inflow_(limits_.bytes_per_second, 1.0, now) {}

    /// Applies `limits` from now on.
    /// @param limits  of the robot's token
    /// @param now     seconds
    void set_limits(LinkLimits limits, double now);

    /// Sets the ids of the sensors that the robot has already described.
    /// @param sensors  Sensor::id of each
    void set_sensors(std::set<std::uint32_t> sensors) { sensors_ = std::move(sensors); }

    /// Checks a message. The sensor of a description counts as one of the robot's sensors.
    /// @param message  a message that the robot sent; kinds without a limit pass
    /// Errors: kTooLarge if the robot has more sensors, or a scan more beams, than the limits allow.
    [[nodiscard]] Result<> check(const wire::Message& message);

    /// Returns how many bytes to read at once: at most `bytes`, and few enough that the pause after them is at most one
    /// second.
    /// @param bytes  space for the read
    [[nodiscard]] std::size_t read_max(std::size_t bytes) const noexcept;

    /// Records a read of `bytes`.
    /// @param bytes  bytes that were read
    /// @param now    seconds; not before the times of earlier calls
    /// @return how long to pause before the next read, in seconds
    [[nodiscard]] double pause_after(std::size_t bytes, double now) noexcept;

private:
    [[nodiscard]] Result<> check_sensor(const Sensor& sensor);
    [[nodiscard]] Result<> check_beams(const wire::ScanBatch& batch) const;

    LinkLimits limits_;
    limits::TokenBucket inflow_;
    std::set<std::uint32_t> sensors_;
};

} // namespace scanloom::link
