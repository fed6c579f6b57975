#pragma once

#include "common/wire/messages.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::wire {

/// Compresses frames with scan batches for slow links. Keeps its tables between them: some hundred KiB.
/// Thread  one at a time.
class Compressor {
public:
    Compressor();
    ~Compressor();
    Compressor(Compressor&&) noexcept;
    Compressor& operator=(Compressor&&) noexcept;

    /// `body` is a frame without its length prefix; nothing where it would not become smaller.
    [[nodiscard]] std::optional<CompressedScanBatch> compress(std::string_view body);

private:
    struct Context;
    std::unique_ptr<Context> context_;
};

/// Bytes that such a batch counts for among those under way: the frame it holds, with a length prefix.
[[nodiscard]] std::size_t bytes_under_way(const CompressedScanBatch& batch) noexcept;

/// The batch that was compressed, checked as by decode(). Nothing larger than kFrameBytesMax is ever made of it.
/// Errors  kTooLarge; kMalformed: no Zstandard frame, or of another size than it says, or with something else than a
///         scan batch in it; those of decode().
[[nodiscard]] Result<ScanBatch> decompress(const CompressedScanBatch& batch);

} // namespace scanloom::wire
