#pragma once

#include "common/error/error.hpp"
#include "common/limits/token_bucket.hpp"
#include "common/wire/messages.hpp"
#include "server/access/token.hpp"

#include <cstddef>
#include <cstdint>
#include <set>

namespace scanloom::ingest {

/// Applies the limits of a token to what its link sends.
/// All times are in seconds of a monotonic clock.
class Allowance {
public:
    /// Starts with the limits of access::anybody(), until set_token() is called.
    explicit Allowance(double now);

    /// Applies the limits of `token` from now on.
    void set_token(access::TokenRef token, double now);
    [[nodiscard]] const access::Token& token() const noexcept { return *token_; }

    /// Sets the ids of the sensors that the robot has already described.
    void set_sensors(std::set<std::uint32_t> sensors) { sensors_ = std::move(sensors); }

    /// Checks a message against the limits. The sensor of a description counts as one of the robot's sensors.
    /// Errors: kTooLarge if the robot has more sensors, or a scan more beams, than the token allows.
    [[nodiscard]] Result<> check(const wire::Message& message);

    /// Returns how many bytes to read at once: at most `bytes`, and few enough that the pause after them is at most one
    /// second.
    [[nodiscard]] std::size_t read_max(std::size_t bytes) const noexcept;

    /// Records a read of `bytes`.
    /// @return how long to pause before the next read, in seconds
    [[nodiscard]] double pause_after(std::size_t bytes, double now) noexcept;

private:
    [[nodiscard]] Result<> check_sensor(const Sensor& sensor);
    [[nodiscard]] Result<> check_beams(const wire::ScanBatch& batch) const;

    access::TokenRef token_;
    TokenBucket inflow_;
    std::set<std::uint32_t> sensors_;
};

} // namespace scanloom::ingest
