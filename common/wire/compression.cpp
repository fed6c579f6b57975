#include "common/wire/compression.hpp"

#include "common/wire/frame_decoder.hpp"

#include <fmt/format.h>
#include <zstd.h>

namespace scanloom::wire {
namespace {

constexpr int kLevel = 3;               // zstd's own default
constexpr std::size_t kFieldBytes = 16; // of protobuf around the compressed bytes

Error malformed(std::string_view what) {
    return {Errc::kMalformed, fmt::format("compressed_scan_batch.zstd {}", what)};
}

} // namespace

struct Compressor::Context {
    struct Free {
        void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
    };
    std::unique_ptr<ZSTD_CCtx, Free> zstd{ZSTD_createCCtx()};
    std::string out;
};

Compressor::Compressor() : context_(std::make_unique<Context>()) {}
Compressor::~Compressor() = default;
Compressor::Compressor(Compressor&&) noexcept = default;
Compressor& Compressor::operator=(Compressor&&) noexcept = default;

std::optional<CompressedScanBatch> Compressor::compress(std::string_view body) {
    context_->out.resize(ZSTD_compressBound(body.size()));
    const std::size_t bytes = ZSTD_compressCCtx(context_->zstd.get(), context_->out.data(), context_->out.size(),
                                                body.data(), body.size(), kLevel);
    if (ZSTD_isError(bytes) != 0 || bytes + kFieldBytes >= body.size()) return std::nullopt;
    return CompressedScanBatch{static_cast<std::uint32_t>(body.size()), context_->out.substr(0, bytes)};
}

std::size_t bytes_under_way(const CompressedScanBatch& batch) noexcept { return batch.size + kLengthPrefixBytes; }

Result<ScanBatch> decompress(const CompressedScanBatch& batch) {
    if (batch.size > kFrameBytesMax) {
        return Error{Errc::kTooLarge, fmt::format("compressed_scan_batch.size is {}, at most {} are allowed",
                                                  batch.size, kFrameBytesMax)};
    }
    // Checked before memory is allocated: a few bytes can expand to gigabytes.
    if (ZSTD_getFrameContentSize(batch.zstd.data(), batch.zstd.size()) != batch.size) {
        return malformed("is no Zstandard frame that states the size of compressed_scan_batch.size");
    }
    std::string body(batch.size, '\0');
    const std::size_t bytes = ZSTD_decompress(body.data(), body.size(), batch.zstd.data(), batch.zstd.size());
    if (ZSTD_isError(bytes) != 0) return malformed(fmt::format("is damaged: {}", ZSTD_getErrorName(bytes)));
    if (bytes != body.size()) return malformed("holds less than it states");
    auto message = decode(body);
    if (!message) return prefixed("compressed_scan_batch: ", message.error());
    auto* scans = std::get_if<ScanBatch>(&*message);
    if (scans == nullptr) return malformed(fmt::format("holds a {}, no scan_batch", name_of(*message)));
    return std::move(*scans);
}

} // namespace scanloom::wire
