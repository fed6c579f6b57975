#pragma once

#include <chrono>
#include <cstdint>
#include <random>

namespace scanloom::robot {

/// How long to wait before the next attempt: doubling from 0.2 s to 10 s, each wait a random part between half and
/// whole, so that many robots do not come back at one moment.
class Backoff {
public:
    explicit Backoff(std::uint32_t seed) : random_(seed) {}

    [[nodiscard]] std::chrono::milliseconds next();

    /// It went well: the next wait is a short one.
    void reset() noexcept { wait_ = kFirst; }

private:
    static constexpr std::chrono::milliseconds kFirst{200};
    static constexpr std::chrono::milliseconds kLongest{10'000};

    std::minstd_rand random_;
    std::chrono::milliseconds wait_ = kFirst;
};

} // namespace scanloom::robot
