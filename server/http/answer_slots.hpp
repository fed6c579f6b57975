#pragma once

#include "common/error/error.hpp"
#include "server/sockets/slots.hpp"

#include <cstddef>
#include <memory>

namespace scanloom::http {

/// Bounds what answers hold in memory, from being made until their last byte is sent: readers may be slow.
/// Small ones are as many as connections; a slow reader of a huge one keeps others from huge ones only.
/// Thread  any.
class AnswerSlots {
public:
    static constexpr std::size_t kSmallMax = std::size_t{256} << 10; ///< bytes
    static constexpr std::size_t kLargeMax = std::size_t{8} << 20;   ///< bytes; more is huge
    static constexpr std::size_t kLargeAnswers = 16;
    static constexpr std::size_t kHugeAnswers = 2;

    /// A slot for an answer of about so many bytes, to be kept with it.
    /// Errors  kOverloaded: all are taken.
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
