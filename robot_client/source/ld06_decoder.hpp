#pragma once

#include "robot_client/source/ld06_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

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
