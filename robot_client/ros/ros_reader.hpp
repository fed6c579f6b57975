#pragma once

#include "robot_client/recordings/recording.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace scanloom::robot {

/// Reads the fields of a ROS message in the order of its definition: packed little-endian values of ROS 1, or CDR of
/// ROS 2, where values are aligned and the first bytes say in which order the bytes of a value are. After the first
/// field that is not there, failed() stays true and values are zero.
/// Threads: one at a time.
/// Source: OMG DDS-XTypes 1.3, 7.4 (CDR); wiki.ros.org/ROS/Technical Overview (ROS 1).
class RosReader {
public:
    /// @param bytes  the message; must outlive this object. Another encoding than kRos1 and kCdr fails
    RosReader(std::string_view bytes, MessageEncoding encoding) : rest_(bytes), encoding_(encoding) {
        if (encoding == MessageEncoding::kRos1) return;
        failed_ = encoding != MessageEncoding::kCdr || bytes.size() < kEncapsulationBytes;
        if (failed_) return;
        const auto representation = static_cast<unsigned char>(bytes[1]);
        const bool is_version_1 = representation <= 1; // CDR_BE, CDR_LE
        const bool is_version_2 = representation == 6 || representation == 7;
        failed_ = bytes[0] != 0 || !(is_version_1 || is_version_2);
        is_swapped_ = representation % 2 == 0;
        alignment_max_ = is_version_2 ? 4 : 8;
        rest_.remove_prefix(kEncapsulationBytes);
    }

    /// Reads a number.
    template <class T>
    requires std::integral<T> || std::floating_point<T>
    [[nodiscard]] T number() {
        align(sizeof(T));
        std::array<char, sizeof(T)> bytes{};
        if (failed_ || rest_.size() < bytes.size()) {
            failed_ = true;
            return {};
        }
        std::memcpy(bytes.data(), rest_.data(), bytes.size());
        if (is_swapped_) std::ranges::reverse(bytes);
        advance(bytes.size());
        return std::bit_cast<T>(bytes);
    }

    /// Reads a text without its final zero byte. It refers to the bytes of the message.
    [[nodiscard]] std::string_view text() {
        const auto size = count(1);
        auto text = rest_.substr(0, size);
        advance(text.size());
        if (encoding_ == MessageEncoding::kCdr && !text.empty() && text.back() == '\0') text.remove_suffix(1);
        return text;
    }

    /// Reads the number of items of a list.
    /// @param bytes_min  of an item: more items than the message has bytes for fail
    [[nodiscard]] std::size_t count(std::size_t bytes_min) {
        const auto count = number<std::uint32_t>();
        if (count <= rest_.size() / bytes_min) return count;
        failed_ = true;
        return 0;
    }

    /// Returns whether a field was not there, or is not possible.
    [[nodiscard]] bool failed() const noexcept { return failed_; }

    /// Returns whether all fields were there and nothing follows but the padding of CDR.
    [[nodiscard]] bool is_complete() const noexcept {
        return !failed_ && rest_.size() <= (encoding_ == MessageEncoding::kCdr ? kPaddingMax : 0);
    }

private:
    static constexpr std::size_t kEncapsulationBytes = 4;
    static constexpr std::size_t kPaddingMax = 7;

    void align(std::size_t size) {
        if (encoding_ != MessageEncoding::kCdr) return;
        const std::size_t alignment = std::min(size, alignment_max_);
        const std::size_t padding = (alignment - offset_ % alignment) % alignment;
        if (padding > rest_.size()) failed_ = true;
        advance(std::min(padding, rest_.size()));
    }

    void advance(std::size_t bytes) {
        rest_.remove_prefix(bytes);
        offset_ += bytes;
    }

    std::string_view rest_;
    MessageEncoding encoding_;
    std::size_t offset_ = 0;        // from what alignment counts
    std::size_t alignment_max_ = 8; // bytes
    bool is_swapped_ = false;
    bool failed_ = false;
};

} // namespace scanloom::robot
