#pragma once

#include "server/foxglove/little_endian.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace scanloom::foxglove {

/// Writes the fields of a message in the Common Data Representation, little-endian, as ROS 2 sends and records
/// messages.
/// Source: OMG CORBA 3.3, part 2, section 9.3; Real-Time Publish-Subscribe 2.2, section 10.
class CdrWriter {
public:
    /// Adds a number. It begins at a multiple of its size, counted after the four bytes that name the representation.
    template <class Number>
    requires std::is_arithmetic_v<Number>
    void add(Number number) {
        while ((bytes_.size() - kHeadBytes) % sizeof number != 0) bytes_ += '\0';
        append_raw(bytes_, number);
    }

    /// Adds a string with its final NUL.
    void add_text(std::string_view text) {
        add_count(text.size() + 1);
        bytes_.append(text) += '\0';
    }

    /// Adds a list of single bytes.
    template <class Byte>
    requires(sizeof(Byte) == 1) void add_bytes(std::span<const Byte> list) {
        add_count(list.size());
        bytes_.append(reinterpret_cast<const char*>(list.data()), list.size());
    }

    /// Adds the number of elements of a list, which are added after it.
    void add_count(std::size_t count) { add(static_cast<std::uint32_t>(count)); }

    /// Returns the message.
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    static constexpr std::size_t kHeadBytes = 4;

    std::string bytes_ = std::string("\0\1\0\0", kHeadBytes); // CDR_LE, no options
};

} // namespace scanloom::foxglove
