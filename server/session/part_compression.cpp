#include "server/session/part_compression.hpp"

#include <zstd.h>

#include <new>

namespace scanloom::session {
namespace {

constexpr int kLevel = 1; // cells repeat; higher levels gain little

} // namespace

void PartCompressor::Free::operator()(ZSTD_CCtx_s* context) const noexcept { ZSTD_freeCCtx(context); }

PartCompressor::PartCompressor() : context_(ZSTD_createCCtx()) {
    if (!context_) throw std::bad_alloc();
}

std::string PartCompressor::compressed(std::string_view bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compressCCtx(context_.get(), out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc(); // the buffer is large enough, so only memory can be missing
    return out.substr(0, size);
}

void PartDecompressor::Free::operator()(ZSTD_DCtx_s* context) const noexcept { ZSTD_freeDCtx(context); }

PartDecompressor::PartDecompressor() : context_(ZSTD_createDCtx()) {
    if (!context_) throw std::bad_alloc();
}

std::optional<std::string> PartDecompressor::decompressed(std::string_view bytes, std::size_t bytes_max) {
    const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (size > bytes_max) return std::nullopt; // error codes are larger numbers
    std::string out(static_cast<std::size_t>(size), '\0');
    const std::size_t got = ZSTD_decompressDCtx(context_.get(), out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(got) != 0 || got != out.size()) return std::nullopt;
    return out;
}

} // namespace scanloom::session
