#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "server/http/response.hpp"

#include <cstddef>
#include <memory>
#include <utility>

namespace scanloom::http {

/// Limits the number of large responses in memory. A permit is held from before the response is built until its last
/// byte is sent, because clients may read slowly. Small responses need no permit: their number is bounded by the
/// connections. A client that reads a huge response slowly delays other huge responses only.
/// Threads: any.
class ResponseLimit {
public:
    static constexpr std::size_t kSmallMax = std::size_t{256} << 10; ///< bytes
    static constexpr std::size_t kLargeMax = std::size_t{8} << 20;   ///< bytes; more is huge
    static constexpr std::size_t kLargeResponses = 16;
    static constexpr std::size_t kHugeResponses = 2;

    /// Takes a permit for a response of about `bytes` bytes.
    /// @return the permit, to be kept as long as the response; null for a small response
    /// Errors: kOverloaded if all permits of this size class are taken.
    [[nodiscard]] Result<limits::Semaphore::Permit> take(std::size_t bytes) const {
        if (bytes <= kSmallMax) return limits::Semaphore::Permit();
        if (auto permit = (bytes <= kLargeMax ? large_ : huge_).try_acquire()) return permit;
        return Error{Errc::kOverloaded, "other large answers are being made and sent; try again soon"};
    }

private:
    const limits::Semaphore large_{kLargeResponses};
    const limits::Semaphore huge_{kHugeResponses};
};

/// Returns a body that keeps `permit` until it has been sent.
template <class Bytes>
[[nodiscard]] Body with_permit(limits::Semaphore::Permit permit, Bytes bytes) {
    struct Held {
        limits::Semaphore::Permit permit;
        Bytes bytes;
    };
    const auto held = std::make_shared<const Held>(Held{std::move(permit), std::move(bytes)});
    return Body(std::shared_ptr<const Bytes>(held, &held->bytes));
}

} // namespace scanloom::http
