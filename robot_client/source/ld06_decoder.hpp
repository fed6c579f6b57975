#pragma once

#include "robot_client/source/ld06_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

/// What came through a decoder so far.
struct Ld06Counts {
    std::uint64_t packets = 0;      ///< whole and plausible
    std::uint64_t crc_failures = 0; ///< headers without a whole packet behind them
    std::uint64_t implausible = 0;  ///< packets whose CRC is right and whose values are not
    std::uint64_t skipped_bytes = 0;

    friend bool operator==(const Ld06Counts&, const Ld06Counts&) = default;
};

/// Finds the packets in a stream of bytes, whatever comes between them and however it is split. Where a header is not
/// followed by a whole packet the search goes on at the byte behind it: the bytes of a damaged packet may hold a
/// header.
class Ld06Decoder {
public:
    void feed(std::span<const std::uint8_t> bytes);

    /// The next packet of what was fed; nothing when more bytes are needed.
    [[nodiscard]] std::optional<Ld06Packet> next();

    /// The stream begins anew: what was fed and is no packet yet is forgotten. Counts go on.
    void restart() noexcept { bytes_.clear(), begin_ = 0; }

    [[nodiscard]] const Ld06Counts& counts() const noexcept { return counts_; }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0; ///< of what was not looked at
    Ld06Counts counts_;
};

} // namespace scanloom::robot
