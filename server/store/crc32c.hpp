#pragma once

#include <cstdint>
#include <string_view>

namespace scanloom::store {

/// CRC-32C (Castagnoli) of two pieces of bytes, one after the other.
[[nodiscard]] std::uint32_t crc32c(std::string_view head, std::string_view tail = {});

} // namespace scanloom::store
