#pragma once

#include <chrono>
#include <cstdint>
#include <random>

namespace scanloom::robot {

struct BackoffWaits {
    std::chrono::milliseconds first{200};
    std::chrono::milliseconds longest{10'000};
};

/// How long to wait before the next attempt: doubling from the first wait to the longest, each a random part between
/// half and whole, so that many robots do not come back at one moment.
class Backoff {
public:
    explicit Backoff(std::uint32_t seed, const BackoffWaits& waits = {})
        : random_(seed), waits_(waits), wait_(waits.first) {}

    [[nodiscard]] std::chrono::milliseconds next();

    /// It went well: the next wait is a short one.
    void reset() noexcept { wait_ = waits_.first; }

private:
    std::minstd_rand random_;
    BackoffWaits waits_;
    std::chrono::milliseconds wait_;
};

} // namespace scanloom::robot
