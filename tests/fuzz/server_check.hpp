#pragma once

#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "tests/fuzz/check.hpp"

#include <string>
#include <string_view>

namespace scanloom::fuzz {

/// Checks that the server decodes a message as it was sent.
inline void check_accepted(const wire::Message& message) {
    std::string frame;
    wire::encode(message, frame);
    const auto decoded = wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes));
    check(decoded.has_value() && *decoded == message, "the server accepts every sensor and scan that is sent");
}

} // namespace scanloom::fuzz
