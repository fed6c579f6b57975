#include "robot_client/lidars/ydlidar_packet.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr std::array<std::uint8_t, 2> kPacketMark{0xAA, 0x55};
constexpr std::size_t kHeadBytes = 10;
constexpr std::size_t kSampleBytes = 2;
constexpr int kSamplesPerMillimetre = 4; // distances are in quarters of a millimetre

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
    return boost::endian::load_little_u16(&bytes[offset]);
}

/// Pre: the whole packet.
bool has_check_code(std::span<const std::uint8_t> packet) {
    std::uint16_t check = 0;
    for (std::size_t at = 0; at < packet.size(); at += 2) {
        if (at != 8) check = static_cast<std::uint16_t>(check ^ word_at(packet, at)); // 8: the code itself
    }
    return check == word_at(packet, 8);
}

/// Returns the angle of a head, degrees. Its lowest bit is always 1.
double angle_at(std::span<const std::uint8_t> packet, std::size_t offset) {
    return (word_at(packet, offset) >> 1) / static_cast<double>(kYdlidarStepsPerDegree);
}

YdlidarPacket read_packet(std::span<const std::uint8_t> packet) {
    const std::size_t samples = (packet.size() - kHeadBytes) / kSampleBytes;
    const double first = angle_at(packet, 4);
    const double span = std::fmod(angle_at(packet, 6) - first + 720.0, 360.0);
    YdlidarPacket read;
    read.starts_turn = (packet[2] & 1U) != 0;
    for (std::size_t i = 0; i < samples; ++i) {
        const int quarters = word_at(packet, kHeadBytes + kSampleBytes * i);
        const double along = samples > 1 ? span * static_cast<double>(i) / static_cast<double>(samples - 1) : 0.0;
        const double distance = quarters / static_cast<double>(kSamplesPerMillimetre);
        const double angle = first + along + ydlidar_correction(distance);
        const auto step = static_cast<std::int32_t>(std::lround(angle * kYdlidarStepsPerDegree));
        read.beams.push_back({(step + kYdlidarStepsPerTurn) % kYdlidarStepsPerTurn,
                              {static_cast<std::uint16_t>(quarters / kSamplesPerMillimetre), 0}});
    }
    return read;
}

} // namespace

double ydlidar_correction(double distance) noexcept {
    constexpr double kOffset = 21.8;    // millimetres, of the camera
    constexpr double kCrossing = 155.3; // millimetres, where the laser crosses the camera's axis
    if (distance <= 0.0) return 0.0;
    return std::atan(kOffset * (kCrossing - distance) / (kCrossing * distance)) * 180.0 / std::numbers::pi;
}

void YdlidarDecoder::feed(std::span<const std::uint8_t> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<YdlidarPacket> YdlidarDecoder::next() {
    for (;;) {
        const auto rest = std::span<const std::uint8_t>(bytes_).subspan(begin_);
        const auto mark = std::min(kPacketMark.size(), rest.size());
        if (!std::equal(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(mark), kPacketMark.begin())) {
            ++begin_;
            continue;
        }
        if (rest.size() < kHeadBytes) return std::nullopt;
        const std::size_t size = kHeadBytes + kSampleBytes * rest[3];
        // Each angle is marked by a bit that is 1. Bytes of another kind need not wait for the end of a packet.
        const bool is_head =
            rest[3] > 0 && (rest[4] & rest[6] & 1U) != 0 && (word_at(rest, 4) >> 1) < 2 * kYdlidarStepsPerTurn;
        if (is_head && rest.size() < size) return std::nullopt;
        if (!is_head || !has_check_code(rest.first(size))) {
            ++begin_;
            ++damaged_;
            continue;
        }
        begin_ += size;
        return read_packet(rest.first(size));
    }
}

} // namespace scanloom::robot
