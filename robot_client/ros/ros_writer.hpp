#pragma once

#include "robot_client/recordings/recording.hpp"

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::robot {

/// Writes the fields of a ROS message in the order of its definition, little-endian: packed values of ROS 1, or CDR of
/// ROS 2, where values are aligned. RosReader reads them.
/// Threads: one at a time.
/// Source: as of RosReader.
class RosWriter {
public:
    /// @param encoding  kRos1 or kCdr
    explicit RosWriter(MessageEncoding encoding) : is_cdr_(encoding == MessageEncoding::kCdr) {
        if (is_cdr_) bytes_.assign(kEncapsulation);
    }

    /// Writes a number.
    template <class T>
    requires std::integral<T> || std::floating_point<T>
    void number(T value) {
        if (is_cdr_) bytes_.resize(bytes_.size() + (sizeof(T) - offset() % sizeof(T)) % sizeof(T));
        const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
        static_assert(std::endian::native == std::endian::little);
        bytes_.append(raw.data(), raw.size());
    }

    /// Writes a text, with a final zero byte in CDR.
    void text(std::string_view text) {
        number(static_cast<std::uint32_t>(text.size() + (is_cdr_ ? 1 : 0)));
        bytes_ += text;
        if (is_cdr_) bytes_ += '\0';
    }

    /// Writes a list of bytes.
    void bytes(std::string_view bytes) {
        number(static_cast<std::uint32_t>(bytes.size()));
        bytes_ += bytes;
    }

    /// Returns the message.
    [[nodiscard]] std::string take() && { return std::move(bytes_); }

private:
    static constexpr std::string_view kEncapsulation{"\0\1\0\0", 4}; // little-endian CDR

    [[nodiscard]] std::size_t offset() const noexcept { return bytes_.size() - kEncapsulation.size(); }

    std::string bytes_;
    bool is_cdr_;
};

} // namespace scanloom::robot
