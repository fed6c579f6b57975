#pragma once

#include "robot_client/lidars/lidar_turn.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// The packets of LDROBOT's spinning lidars LD06 and LD19 (D300 and D500 kits, STL-19P, STL-27L).
/// Source: LDROBOT, LD06 development manual; ldrobotSensorTeam/ldlidar_stl_ros2 where the manual is incomplete.
namespace scanloom::robot {

inline constexpr std::size_t kLd06PacketBytes = 47;
inline constexpr std::size_t kLd06PacketPoints = 12;
inline constexpr std::array<std::uint8_t, 2> kLd06Header{0x54, 0x2C};
inline constexpr std::uint16_t kLd06ClockWrap = 30'000; ///< milliseconds

/// Angles within a packet are start + i * span / 11 hundredths of a degree: whole multiples of 0.01 / 11 degree.
inline constexpr std::int32_t kLd06StepsPerDegree = 1100;
inline constexpr std::int32_t kLd06StepsPerTurn = 360 * kLd06StepsPerDegree;

struct Ld06Packet {
    std::uint16_t speed = 0;       ///< degrees per second
    std::uint16_t start_angle = 0; ///< of the first point; 0.01 degree, clockwise seen from above, 0 = ahead
    std::array<LidarPoint, kLd06PacketPoints> points;
    std::uint16_t end_angle = 0; ///< of the last point
    std::uint16_t timestamp = 0; ///< milliseconds, wraps at kLd06ClockWrap

    friend bool operator==(const Ld06Packet&, const Ld06Packet&) = default;
};

/// Returns the CRC-8 with polynomial 0x4D, initial value 0, not reflected. Over a whole packet it is 0.
[[nodiscard]] std::uint8_t ld06_crc(std::span<const std::uint8_t> bytes) noexcept;

/// Decodes a packet. Pre: the bytes begin with the header and their CRC is correct.
[[nodiscard]] Ld06Packet read_ld06_packet(std::span<const std::uint8_t, kLd06PacketBytes> bytes) noexcept;

/// Returns false for values that no sensor sends, although the CRC is correct: one damaged packet in 256 has a correct
/// CRC. Accepts sensors of at least 2250 samples per second, and therefore those of 4500 (LD06, LD19) with up to three
/// times the span of their speed.
[[nodiscard]] bool is_plausible(const Ld06Packet& packet) noexcept;

/// Returns the steps from the first point to the last, clockwise.
[[nodiscard]] std::int32_t steps_spanned(const Ld06Packet& packet) noexcept;

/// Counts of what a decoder has read so far.
struct Ld06Counts {
    std::uint64_t packets = 0;      ///< complete and plausible
    std::uint64_t crc_failures = 0; ///< headers not followed by a complete packet
    std::uint64_t implausible = 0;  ///< packets with a correct CRC and impossible values
    std::uint64_t skipped_bytes = 0;

    friend bool operator==(const Ld06Counts&, const Ld06Counts&) = default;
};

/// Finds the packets in a stream of bytes, however it is split and whatever is between them. If a header is not
/// followed by a complete packet, the search continues at the next byte, because the bytes of a damaged packet may
/// contain a header.
class Ld06Decoder {
public:
    void feed(std::span<const std::uint8_t> bytes);

    /// Returns the next packet of the bytes fed, or nullopt if more bytes are needed.
    [[nodiscard]] std::optional<Ld06Packet> next();

    /// Starts a new stream: drops bytes that do not form a packet yet. The counts continue.
    void restart() noexcept { bytes_.clear(), begin_ = 0; }

    [[nodiscard]] const Ld06Counts& counts() const noexcept { return counts_; }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0; ///< start of the bytes not examined
    Ld06Counts counts_;
};

} // namespace scanloom::robot
