#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Packs the ranges of a scan into about a third of their bytes, for the log, at about the speed of copying them.
///
/// Format: the number of beams as u16, then blocks of 16 beams; the last block has the remaining beams. A block is a
///         byte w (0, 1, 2 or 4) and w bytes per beam. A beam is stored as its difference to the previous beam, the
///         first one to 0. The difference wraps around at 32 bits and is zigzag-encoded: its sign is the lowest bit, so
///         that small differences need few bytes. All numbers are little-endian.
namespace scanloom::wire {

/// Packs ranges. Precondition: there are at most kBeamsMax.
[[nodiscard]] std::string pack_ranges(std::span<const RangeMm> ranges);

/// Unpacks ranges. Blocks may be wider than their numbers need.
/// @param packed  bytes in the format above
/// @return the ranges; nullopt if the bytes do not have exactly this format, or hold more than kBeamsMax ranges
[[nodiscard]] std::optional<std::vector<RangeMm>> unpack_ranges(std::string_view packed);

} // namespace scanloom::wire
