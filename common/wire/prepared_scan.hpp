#pragma once

#include "common/scan/scan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace scanloom::wire {

/// A scan whose bytes are made once, to be sent many times under other numbers and at other times: that costs a copy.
class PreparedScan {
public:
    /// The scan's own seq and stamp do not matter.
    explicit PreparedScan(Scan scan);

    /// The fields behind seq and stamp, as they travel.
    [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

private:
    std::string bytes_;
};

/// A prepared scan as one robot sends it.
struct NumberedScan {
    const PreparedScan* scan = nullptr;
    std::uint64_t seq = 0; ///< above 0
    double stamp = 0.0;    ///< seconds
};

/// Appends the scans to `out` as a ScanBatch frame, length prefix and checksum included: the same bytes as encode()
/// gives.
/// Pre     at least one scan; batch_frame_size(scans) <= kLengthPrefixBytes + kFrameBytesMax
/// Thread  any.
void encode_batch(std::span<const NumberedScan> scans, std::string& out);

/// Bytes of that frame, length prefix and checksum included.
[[nodiscard]] std::size_t batch_frame_size(std::span<const NumberedScan> scans);

} // namespace scanloom::wire
