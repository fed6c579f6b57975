#include "robot_client/lidars/ld06_packet.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>

namespace scanloom::robot {
namespace {

constexpr int kAnglesPerTurn = 36'000; // of 0.01 degree

constexpr std::array<std::uint8_t, 256> make_crc_table() {
    constexpr unsigned kPolynomial = 0x4D;
    std::array<std::uint8_t, 256> table{};
    for (unsigned byte = 0; byte < table.size(); ++byte) {
        unsigned crc = byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80U) != 0 ? crc << 1 ^ kPolynomial : crc << 1;
        table[byte] = static_cast<std::uint8_t>(crc);
    }
    return table;
}

constexpr auto kCrcTable = make_crc_table();

int angles_spanned(const Ld06Packet& packet) {
    return (packet.end_angle + kAnglesPerTurn - packet.start_angle) % kAnglesPerTurn;
}

} // namespace

std::uint8_t ld06_crc(std::span<const std::uint8_t> bytes) noexcept {
    std::uint8_t crc = 0;
    for (const std::uint8_t byte : bytes) crc = kCrcTable[crc ^ byte];
    return crc;
}

Ld06Packet read_ld06_packet(std::span<const std::uint8_t, kLd06PacketBytes> bytes) noexcept {
    const auto number_at = [&](std::size_t offset) { return boost::endian::load_little_u16(&bytes[offset]); };
    Ld06Packet packet;
    packet.speed = number_at(2);
    packet.start_angle = number_at(4);
    for (std::size_t i = 0; i < packet.points.size(); ++i) packet.points[i] = {number_at(6 + 3 * i), bytes[8 + 3 * i]};
    packet.end_angle = number_at(42);
    packet.timestamp = number_at(44);
    return packet;
}

bool is_plausible(const Ld06Packet& packet) noexcept {
    // The vendor's test, at half its rate: a packet spans the angle of 12 samples, plus half as much. The vendor's
    // driver assumes 4500 samples per second, as LD06 and LD19 take them. But the example in the LD06's own manual was
    // taken at 2250 and must pass, too.
    constexpr double kSamplesPerSecondMin = 2250.0;
    constexpr double kSpanMargin = 1.5;
    const int degrees = angles_spanned(packet) / 100; // rounded down, as in the vendor's driver
    const double degrees_max = packet.speed * kLd06PacketPoints / kSamplesPerSecondMin * kSpanMargin;
    return packet.start_angle <= kAnglesPerTurn && packet.end_angle <= kAnglesPerTurn &&
           packet.timestamp <= kLd06ClockWrap && degrees <= degrees_max;
}

std::int32_t steps_spanned(const Ld06Packet& packet) noexcept {
    return angles_spanned(packet) * kLd06StepsPerDegree / 100;
}

void Ld06Decoder::feed(std::span<const std::uint8_t> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<Ld06Packet> Ld06Decoder::next() {
    for (;;) {
        const auto rest = std::span<const std::uint8_t>(bytes_).subspan(begin_);
        const auto header = std::min(kLd06Header.size(), rest.size());
        if (!std::equal(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(header), kLd06Header.begin())) {
            ++begin_;
            ++counts_.skipped_bytes;
            continue;
        }
        if (rest.size() < kLd06PacketBytes) return std::nullopt;
        const auto bytes = rest.first<kLd06PacketBytes>();
        if (ld06_crc(bytes) != 0) {
            ++begin_;
            ++counts_.skipped_bytes;
            ++counts_.crc_failures;
            continue;
        }
        begin_ += kLd06PacketBytes;
        const Ld06Packet packet = read_ld06_packet(bytes);
        if (is_plausible(packet)) {
            ++counts_.packets;
            return packet;
        }
        ++counts_.implausible;
    }
}

} // namespace scanloom::robot
