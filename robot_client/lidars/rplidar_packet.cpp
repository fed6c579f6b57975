#include "robot_client/lidars/rplidar_packet.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>

namespace scanloom::robot {
namespace {

/// So many points in a row must have correct check bits after a damaged one: random bytes have them once in 4000 times.
constexpr std::size_t kNodesInStep = 4;

} // namespace

std::optional<RplidarPoint> read_rplidar_node(std::span<const std::uint8_t, kRplidarNodeBytes> bytes) {
    const bool starts = (bytes[0] & 1U) != 0;
    const bool continues = (bytes[0] & 2U) != 0;
    const auto angle = boost::endian::load_little_u16(&bytes[1]);
    const std::int32_t step = angle >> 1;
    if (starts == continues || (angle & 1U) == 0 || step > kRplidarStepsPerTurn) return std::nullopt;
    return RplidarPoint{starts, step % kRplidarStepsPerTurn, boost::endian::load_little_u16(&bytes[3]),
                        static_cast<std::uint8_t>(bytes[0] >> 2)};
}

std::optional<RplidarCapsule> read_rplidar_capsule(std::span<const std::uint8_t, kRplidarCapsuleBytes> bytes) {
    constexpr std::size_t kChecked = 2; // the first byte that the checksum covers
    constexpr std::size_t kCabins = 4;  // the first pair of points
    constexpr std::size_t kCabinBytes = 5;
    if (bytes[0] >> 4 != 0xA || bytes[1] >> 4 != 0x5) return std::nullopt;
    unsigned check = 0;
    for (const std::uint8_t byte : bytes.subspan(kChecked)) check ^= byte;
    if (check != ((bytes[0] & 0xFU) | (bytes[1] & 0xFU) << 4)) return std::nullopt;
    const auto angle = boost::endian::load_little_u16(&bytes[2]);
    RplidarCapsule capsule;
    capsule.is_first = (angle & 0x8000U) != 0;
    capsule.start = angle & 0x7FFF;
    if (capsule.start > kRplidarStepsPerTurn) return std::nullopt;
    for (std::size_t i = 0; i < capsule.points.size(); ++i) {
        const std::size_t cabin = kCabins + i / 2 * kCabinBytes;
        const auto distance = boost::endian::load_little_u16(&bytes[cabin + i % 2 * 2]);
        const unsigned offsets = bytes[cabin + 4];
        const unsigned low = i % 2 == 0 ? offsets & 0xFU : offsets >> 4;
        capsule.points[i] = {static_cast<std::uint16_t>(distance & 0xFFFCU),
                             static_cast<std::uint8_t>(low | (distance & 3U) << 4)};
    }
    return capsule;
}

std::array<RplidarPoint, kRplidarCapsulePoints> points_of(const RplidarCapsule& capsule, const RplidarCapsule& next,
                                                          std::optional<std::int32_t>& angle) {
    constexpr auto kCount = static_cast<std::int32_t>(kRplidarCapsulePoints);
    constexpr std::int32_t kStepsPerEighth = kRplidarStepsPerDegree / 8;
    const std::int32_t span = (next.start - capsule.start + 2 * kRplidarStepsPerTurn) % kRplidarStepsPerTurn;
    std::array<RplidarPoint, kRplidarCapsulePoints> points;
    for (std::int32_t i = 0; i < kCount; ++i) {
        const std::int32_t at = (capsule.start + span * i / kCount) % kRplidarStepsPerTurn;
        const auto& [distance, offset] = capsule.points[static_cast<std::size_t>(i)];
        const std::int32_t step = at - offset * kStepsPerEighth;
        points[static_cast<std::size_t>(i)] = {angle && at < *angle - kRplidarStepsPerTurn / 2,
                                               (step + kRplidarStepsPerTurn) % kRplidarStepsPerTurn, distance, 0};
        angle = at;
    }
    return points;
}

void RplidarDecoder::feed(std::span<const std::uint8_t> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<RplidarPoint> RplidarDecoder::next() {
    if (is_express_) {
        while (given_ == points_.size()) {
            if (!read_capsule()) return std::nullopt;
        }
        return points_[given_++];
    }
    if (!find_node()) return std::nullopt;
    const auto point = read_rplidar_node(std::span(bytes_).subspan(begin_).first<kRplidarNodeBytes>());
    begin_ += kRplidarNodeBytes;
    return point;
}

void RplidarDecoder::lose() {
    ++begin_;
    if (is_in_step_) ++damaged_;
    is_in_step_ = false;
    before_.reset();
}

/// Sets begin_ to the next point. @return false if more bytes are needed
bool RplidarDecoder::find_node() {
    for (;;) {
        const std::size_t wanted = is_in_step_ ? 1 : kNodesInStep;
        const auto rest = std::span<const std::uint8_t>(bytes_).subspan(begin_);
        bool is_node = true;
        for (std::size_t i = 0; i < wanted && is_node; ++i) {
            if (rest.size() < (i + 1) * kRplidarNodeBytes) return false;
            is_node = read_rplidar_node(rest.subspan(i * kRplidarNodeBytes).first<kRplidarNodeBytes>()).has_value();
        }
        if (is_node) {
            is_in_step_ = true;
            return true;
        }
        lose();
    }
}

/// Reads the next capsule, and sets the points of the one before. @return false if more bytes are needed
bool RplidarDecoder::read_capsule() {
    for (;;) {
        const auto rest = std::span<const std::uint8_t>(bytes_).subspan(begin_);
        if (rest.size() < kRplidarCapsuleBytes) return false;
        const auto capsule = read_rplidar_capsule(rest.first<kRplidarCapsuleBytes>());
        if (!capsule) {
            lose();
            continue;
        }
        begin_ += kRplidarCapsuleBytes;
        is_in_step_ = true;
        if (before_ && !capsule->is_first) {
            points_ = points_of(*before_, *capsule, angle_);
            given_ = 0;
        }
        before_ = capsule;
        return true;
    }
}

} // namespace scanloom::robot
