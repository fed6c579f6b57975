#pragma once

#include "common/error/error.hpp"
#include "server/sockets/slots.hpp"

#include <cstddef>
#include <memory>

namespace scanloom::http {

/// Limits the number of large responses in memory. A slot is held from before the response is built until its last byte
/// is sent, because clients may read slowly. Small responses need no slot: their number is bounded by the connections.
/// A client that reads a huge response slowly delays other huge responses only.
/// Threads: any.
class AnswerSlots {
public:
    static constexpr std::size_t kSmallMax = std::size_t{256} << 10; ///< bytes
    static constexpr std::size_t kLargeMax = std::size_t{8} << 20;   ///< bytes; more is huge
    static constexpr std::size_t kLargeAnswers = 16;
    static constexpr std::size_t kHugeAnswers = 2;

    /// Takes a slot for a response of about `bytes` bytes.
    /// @return the slot, to be kept as long as the response; null for a small response
    /// Errors: kOverloaded if all slots of this size class are taken.
    [[nodiscard]] Result<std::shared_ptr<const void>> take(std::size_t bytes) const {
        if (bytes <= kSmallMax) return std::shared_ptr<const void>();
        if (auto slot = (bytes <= kLargeMax ? large_ : huge_).try_take()) return slot;
        return Error{Errc::kOverloaded, "other large answers are being made and sent; try again soon"};
    }

private:
    const sockets::Slots large_{kLargeAnswers};
    const sockets::Slots huge_{kHugeAnswers};
};

} // namespace scanloom::http
