#pragma once

#include "robot_client/lidars/ld06_packet.hpp"

#include <boost/endian/conversion.hpp>

#include <cstdint>
#include <vector>

/// Bytes in the format that an LD06 sends.
namespace scanloom::testing_support {

using Bytes = std::vector<std::uint8_t>;

inline Bytes bytes_of(const robot::Ld06Packet& packet) {
    Bytes bytes(robot::kLd06PacketBytes);
    const auto put = [&](std::size_t at, std::uint16_t value) { boost::endian::store_little_u16(&bytes[at], value); };
    bytes[0] = robot::kLd06Header[0];
    bytes[1] = robot::kLd06Header[1];
    put(2, packet.speed);
    put(4, packet.start_angle);
    for (std::size_t i = 0; i < packet.points.size(); ++i) {
        put(6 + 3 * i, packet.points[i].distance);
        bytes[8 + 3 * i] = packet.points[i].confidence;
    }
    put(42, packet.end_angle);
    put(44, packet.timestamp);
    bytes[46] = robot::ld06_crc({bytes.data(), bytes.size() - 1});
    return bytes;
}

inline void append(Bytes& bytes, const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

/// A sensor that turns ten times a second and measures 4500 points a second: 12.5 packets for a third of a turn. Each
/// direction has its own range: 1 m at 0 degrees, and 10 mm more for each degree.
class Ld06Spinner {
public:
    explicit Ld06Spinner(int angle = 0, int milliseconds = 0) : angle_(angle), microseconds_(milliseconds * 1000) {}

    robot::Ld06Packet next() {
        robot::Ld06Packet packet;
        packet.speed = 3600;
        packet.start_angle = static_cast<std::uint16_t>(angle_);
        packet.end_angle = static_cast<std::uint16_t>((angle_ + 11 * kGap) % 36'000);
        for (int i = 0; i < 12; ++i) {
            const int degrees = (angle_ + i * kGap) % 36'000 / 100;
            packet.points[static_cast<std::size_t>(i)] = {static_cast<std::uint16_t>(1000 + 10 * degrees), 200};
        }
        packet.timestamp = static_cast<std::uint16_t>(microseconds_ / 1000 % robot::kLd06ClockWrap);
        angle_ = (angle_ + 12 * kGap) % 36'000;
        microseconds_ += kMicroseconds;
        return packet;
    }

    Bytes next_bytes(int packets) {
        Bytes bytes;
        for (int i = 0; i < packets; ++i) append(bytes, bytes_of(next()));
        return bytes;
    }

    void skip(int packets) {
        for (int i = 0; i < packets; ++i) (void)next();
    }

private:
    static constexpr int kGap = 80;            // 0.01 degree
    static constexpr int kMicroseconds = 2667; // per packet

    int angle_; // 0.01 degree
    std::int64_t microseconds_;
};

} // namespace scanloom::testing_support
