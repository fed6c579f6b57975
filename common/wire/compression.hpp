#pragma once

#include "common/wire/messages.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::wire {

/// Compresses frames with scan batches, for slow links. Keeps its tables between frames: some hundred KiB.
/// Threads: one at a time.
class Compressor {
public:
    Compressor();
    ~Compressor();
    Compressor(Compressor&&) noexcept;
    Compressor& operator=(Compressor&&) noexcept;

    /// Compresses a frame.
    /// @param body  the frame without its length prefix
    /// @return the batch; nullopt if the frame would not become smaller
    [[nodiscard]] std::optional<CompressedScanBatch> compress(std::string_view body);

private:
    struct Context;
    std::unique_ptr<Context> context_;
};

/// Returns the bytes of credit that the batch uses: the size of the frame that it holds, with a length prefix.
[[nodiscard]] std::size_t bytes_under_way(const CompressedScanBatch& batch) noexcept;

/// Decompresses a batch and validates it as decode() does. Never decompresses to more than kFrameBytesMax.
/// Errors: kTooLarge if the batch states a larger size; kMalformed if it is not a Zstandard frame, has a size that
///         differs from the stated one, or does not hold a scan batch; those of decode().
[[nodiscard]] Result<ScanBatch> decompress(const CompressedScanBatch& batch);

} // namespace scanloom::wire
