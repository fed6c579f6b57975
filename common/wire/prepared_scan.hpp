#pragma once

#include "common/scan/scan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace scanloom::wire {

/// A scan that is serialized once and sent many times with other seqs and stamps. Each time costs only a copy.
class PreparedScan {
public:
    /// Serializes the scan without its seq and stamp.
    explicit PreparedScan(Scan scan);

    /// Returns the serialized fields after seq and stamp.
    [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

private:
    std::string bytes_;
};

/// A prepared scan with the seq and stamp under which a robot sends it.
struct NumberedScan {
    const PreparedScan* scan = nullptr;
    std::uint64_t seq = 0; ///< above 0
    double stamp = 0.0;    ///< seconds
};

/// Appends the scans to `out` as a ScanBatch frame with its length prefix and checksum, byte for byte as encode() does.
/// Precondition: there is at least one scan, and batch_frame_size(scans) <= kLengthPrefixBytes + kFrameBytesMax.
/// Threads: any thread.
void encode_batch(std::span<const NumberedScan> scans, std::string& out);

/// Returns the bytes that encode_batch() appends for these scans.
[[nodiscard]] std::size_t batch_frame_size(std::span<const NumberedScan> scans);

} // namespace scanloom::wire
