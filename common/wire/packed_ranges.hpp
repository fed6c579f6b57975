#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The ranges of a scan in about a third of their bytes, for the log, at about the speed of copying them.
///
/// Shapes  the number of beams, u16; then blocks of 16 beams, the last one of what is left: a byte w, 0, 1, 2 or 4, and w
///         bytes a beam. What is kept of a beam is the difference to the one before it, of the first to 0, as 32 bits
///         that wrap around; of these the sign is the lowest bit (zigzag), so that small ones need few bytes. All
///         numbers are little-endian.
namespace scanloom::wire {

/// Pre  at most kBeamsMax ranges.
[[nodiscard]] std::string pack_ranges(std::span<const RangeMm> ranges);

/// Nothing when the bytes have not the shape above, to the last one, for at most kBeamsMax ranges. Blocks may be wider
/// than their numbers need.
[[nodiscard]] std::optional<std::vector<RangeMm>> unpack_ranges(std::string_view packed);

} // namespace scanloom::wire
