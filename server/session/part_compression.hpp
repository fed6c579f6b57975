#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

/// The parts of a checkpoint that are worth compressing, by Zstandard at its fastest. The store compresses nothing itself:
/// most of what it holds are scans, whose ranges are packed already.
namespace scanloom::session {

/// Keeps its tables from part to part: some hundred KiB.
/// Errors  std::bad_alloc: memory ran out.
/// Thread  one at a time.
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

/// Errors  std::bad_alloc: memory ran out.
/// Thread  one at a time.
class PartDecompressor {
public:
    PartDecompressor();

    /// The bytes again; nothing where they are damaged or more than `bytes_max`, which are never allocated.
    [[nodiscard]] std::optional<std::string> decompressed(std::string_view bytes, std::size_t bytes_max);

private:
    struct Free {
        void operator()(ZSTD_DCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

} // namespace scanloom::session
