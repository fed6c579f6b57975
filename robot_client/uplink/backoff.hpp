#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>

namespace scanloom::robot {

struct BackoffWaits {
    std::chrono::milliseconds first{200};
    std::chrono::milliseconds longest{10'000};
};

/// Chooses how long to wait before the next attempt. The wait doubles from the first to the longest; a random part
/// between half and all of it is used, so that many robots do not reconnect at the same moment.
class Backoff {
public:
    explicit Backoff(std::uint32_t seed, const BackoffWaits& waits = {})
        : random_(seed), waits_(waits), wait_(waits.first) {}

    [[nodiscard]] std::chrono::milliseconds next() {
        std::uniform_int_distribution<std::int64_t> part(wait_.count() / 2, wait_.count());
        const std::chrono::milliseconds chosen{part(random_)};
        wait_ = std::min(2 * wait_, waits_.longest);
        return chosen;
    }

    /// Makes the next wait the first, short one. Call it after a success.
    void reset() noexcept { wait_ = waits_.first; }

private:
    std::minstd_rand random_;
    BackoffWaits waits_;
    std::chrono::milliseconds wait_;
};

} // namespace scanloom::robot
