#include "robot_client/source/ld06_decoder.hpp"

#include <algorithm>

namespace scanloom::robot {

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
