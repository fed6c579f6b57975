#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/access/bucket.hpp"
#include "server/access/token.hpp"

#include <cstddef>
#include <cstdint>
#include <set>

namespace scanloom::ingest {

/// What a link may send, as the limits of its token have it.
/// Times   seconds of a clock that is never put back.
class Allowance {
public:
    /// Anybody's, until there is a token.
    explicit Allowance(double now);

    /// From now on this token's limits hold.
    void set_token(access::TokenRef token, double now);
    [[nodiscard]] const access::Token& token() const noexcept { return *token_; }

    /// The robot has described these before.
    void set_sensors(std::set<std::uint32_t> sensors) { sensors_ = std::move(sensors); }

    /// Counts a sensor that is described among the robot's.
    /// Errors  kTooLarge: a sensor too many, a scan with too many beams.
    [[nodiscard]] Result<> check(const wire::Message& message);

    /// Bytes to be read at once, at most so many: few enough that a pause after them is a second at most.
    [[nodiscard]] std::size_t read_max(std::size_t bytes) const noexcept;

    /// So many were read. @return seconds in which no more may be.
    [[nodiscard]] double pause_after(std::size_t bytes, double now) noexcept;

private:
    [[nodiscard]] Result<> check_sensor(const Sensor& sensor);
    [[nodiscard]] Result<> check_beams(const wire::ScanBatch& batch) const;

    access::TokenRef token_;
    access::Bucket inflow_;
    std::set<std::uint32_t> sensors_;
};

} // namespace scanloom::ingest
