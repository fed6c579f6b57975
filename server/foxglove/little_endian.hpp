#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace scanloom::foxglove {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

/// Appends a number or enumerator, little-endian.
template <class Value>
requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) void append_raw(std::string& bytes, Value value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
}

} // namespace scanloom::foxglove
