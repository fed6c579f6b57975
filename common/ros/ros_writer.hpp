#pragma once

#include "common/geometry/pose2.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace scanloom {

/// How ROS represents messages as bytes.
enum class RosEncoding {
    kRos1, ///< packed values
    kCdr,  ///< of ROS 2: aligned values after four bytes that name the representation
};

/// Writes the fields of a message of ROS in the order of its definition, little-endian.
/// Threads: one at a time.
/// Source: wiki.ros.org/msg; OMG CORBA 3.3, part 2, section 9.3; Real-Time Publish-Subscribe 2.2, section 10.
class RosWriter {
public:
    explicit RosWriter(RosEncoding encoding) : is_cdr_(encoding == RosEncoding::kCdr) {
        if (is_cdr_) bytes_.assign(kEncapsulation);
    }

    /// Adds a number. In CDR it begins at a multiple of its size, counted after the first four bytes.
    template <class Number>
    requires std::is_arithmetic_v<Number>
    void add(Number number) {
        static_assert(std::endian::native == std::endian::little);
        if (is_cdr_) bytes_.resize(bytes_.size() + (sizeof number - offset() % sizeof number) % sizeof number);
        const auto raw = std::bit_cast<std::array<char, sizeof number>>(number);
        bytes_.append(raw.data(), raw.size());
    }

    /// Adds the number of elements of a list, which are added after it.
    void add_count(std::size_t count) { add(static_cast<std::uint32_t>(count)); }

    /// Adds a text, in CDR with a final zero byte.
    void add_text(std::string_view text) {
        add_count(text.size() + (is_cdr_ ? 1 : 0));
        bytes_ += text;
        if (is_cdr_) bytes_ += '\0';
    }

    /// Adds a list of single bytes.
    template <class Byte>
    requires(sizeof(Byte) == 1) void add_bytes(std::span<const Byte> list) {
        add_count(list.size());
        bytes_.append(reinterpret_cast<const char*>(list.data()), list.size());
    }

    /// Adds a time.
    /// @param nanoseconds  since the epoch of the clock; at most 2^31 - 1 s
    void add_time(std::int64_t nanoseconds) {
        constexpr std::int64_t kSecond = 1'000'000'000;
        add(static_cast<std::int32_t>(nanoseconds / kSecond));
        add(static_cast<std::uint32_t>(nanoseconds % kSecond));
    }

    /// Adds a std_msgs/Header.
    /// @param nanoseconds  as for add_time()
    void add_header(std::int64_t nanoseconds, std::string_view frame) {
        if (!is_cdr_) add(std::uint32_t{0}); // seq, which ROS 1 sets itself
        add_time(nanoseconds);
        add_text(frame);
    }

    /// Adds a geometry_msgs/Pose or geometry_msgs/Transform.
    /// @param pose  metres and radians in the plane
    void add_pose(const Pose2& pose) {
        for (const double metres : {pose.x, pose.y, 0.0}) add(metres);
        for (const double part : {0.0, 0.0, std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0)}) add(part);
    }

    /// Returns the message.
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    static constexpr std::string_view kEncapsulation{"\0\1\0\0", 4}; // little-endian CDR

    [[nodiscard]] std::size_t offset() const noexcept { return bytes_.size() - kEncapsulation.size(); }

    std::string bytes_;
    bool is_cdr_;
};

} // namespace scanloom
