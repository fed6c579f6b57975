#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

/// Compression of a checkpoint's chunks by Zstandard at its fastest level. The store itself does not compress, because
/// most of its data are scans, whose ranges are packed already.
namespace scanloom::session {

/// Compresses parts. Keeps tables of a few hundred KiB between parts.
/// Throws std::bad_alloc if memory ran out.
/// Threads: one at a time.
class PartCompressor {
public:
    PartCompressor();

    [[nodiscard]] std::string compressed(std::string_view bytes);

private:
    struct Free {
        void operator()(ZSTD_CCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_CCtx_s, Free> context_;
};

/// Decompresses parts.
/// Throws std::bad_alloc if memory ran out.
/// Threads: one at a time.
class PartDecompressor {
public:
    PartDecompressor();

    /// Returns the original bytes; nullopt if they are damaged or more than `bytes_max`. Never allocates more than
    /// `bytes_max`.
    [[nodiscard]] std::optional<std::string> decompressed(std::string_view bytes, std::size_t bytes_max);

private:
    struct Free {
        void operator()(ZSTD_DCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

} // namespace scanloom::session
