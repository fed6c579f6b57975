#include "server/tiles/png.hpp"

#include <spng.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <new>

namespace scanloom::tiles {
namespace {

int bits_for(std::size_t colours) noexcept {
    for (const int bits : {1, 2, 4}) {
        if (colours <= std::size_t{1} << bits) return bits;
    }
    return 8;
}

std::size_t packed_size(std::int32_t width, int bits) noexcept {
    return (static_cast<std::size_t>(width) * static_cast<std::size_t>(bits) + 7) / 8;
}

/// Packs pixels into bytes, the leftmost pixel in the highest bits; unused bits of the last byte are 0.
template <int kBits>
void pack(std::span<const std::uint8_t> pixels, std::uint8_t* to) noexcept {
    constexpr std::size_t kEach = 8 / kBits;
    std::size_t n = 0;
    for (; n + kEach <= pixels.size(); n += kEach) {
        unsigned byte = 0;
        for (std::size_t i = 0; i < kEach; ++i) byte = byte << kBits | pixels[n + i];
        *to++ = static_cast<std::uint8_t>(byte);
    }
    if (n == pixels.size()) return;
    unsigned byte = 0;
    for (std::size_t i = 0; i < kEach; ++i, ++n) byte = byte << kBits | (n < pixels.size() ? pixels[n] : 0U);
    *to = static_cast<std::uint8_t>(byte);
}

/// Appends what libspng writes to the file in memory.
int append(spng_ctx*, void* file, void* bytes, std::size_t count) noexcept {
    try {
        auto& png = *static_cast<Bytes*>(file);
        const auto* first = static_cast<const std::uint8_t*>(bytes);
        png.insert(png.end(), first, first + count);
        return SPNG_OK;
    } catch (const std::bad_alloc&) {
        return SPNG_IO_ERROR;
    }
}

/// Checks a result of libspng. All arguments are valid, so that it fails only if memory runs out.
void check(int result) {
    if (result != SPNG_OK && result != SPNG_EOI) throw std::bad_alloc();
}

void set_palette(spng_ctx* context, std::span<const PaletteEntry> palette) {
    assert(palette.size() <= 256);
    spng_plte colours{};
    spng_trns opacities{};
    for (const auto& [colour, opacity] : palette) {
        colours.entries[colours.n_entries++] = {colour.red, colour.green, colour.blue, 0};
        opacities.type3_alpha[opacities.n_type3_entries++] = opacity;
    }
    check(spng_set_plte(context, &colours));
    const bool is_opaque = std::ranges::all_of(palette, [](const PaletteEntry& entry) { return entry.opacity == 255; });
    if (!is_opaque) check(spng_set_trns(context, &opacities));
}

} // namespace

void PngWriter::FreeContext::operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }

PngWriter::PngWriter(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette)
    : bits_(palette.empty() ? 8 : bits_for(palette.size())), packed_(packed_size(width, bits_)),
      context_(spng_ctx_new(SPNG_CTX_ENCODER)) {
    if (!context_) throw std::bad_alloc();
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(width);
    header.height = static_cast<std::uint32_t>(height);
    header.bit_depth = static_cast<std::uint8_t>(bits_);
    header.color_type = palette.empty() ? SPNG_COLOR_TYPE_GRAYSCALE : SPNG_COLOR_TYPE_INDEXED;
    check(spng_set_png_stream(context_.get(), append, &png_));
    check(spng_set_option(context_.get(), SPNG_FILTER_CHOICE, SPNG_DISABLE_FILTERING));
    check(spng_set_option(context_.get(), SPNG_IMG_COMPRESSION_STRATEGY, Z_RLE));
    check(spng_set_ihdr(context_.get(), &header));
    if (!palette.empty()) set_palette(context_.get(), palette);
    constexpr int kRowByRow = SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE;
    check(spng_encode_image(context_.get(), nullptr, 0, SPNG_FMT_PNG, kRowByRow));
}

void PngWriter::add_row(std::span<const std::uint8_t> pixels) {
    switch (bits_) {
    case 1: pack<1>(pixels, packed_.data()); break;
    case 2: pack<2>(pixels, packed_.data()); break;
    case 4: pack<4>(pixels, packed_.data()); break;
    default: std::ranges::copy(pixels, packed_.begin());
    }
    check(spng_encode_row(context_.get(), packed_.data(), packed_.size()));
}

namespace {

/// Converts codes to the writer's pixels.
using PixelOfCode = std::array<std::uint8_t, 256>;

Bytes written(PngWriter& png, std::span<const Code> codes, std::size_t width, const PixelOfCode& pixel_of) {
    Bytes row(width);
    for (; !codes.empty(); codes = codes.subspan(width)) {
        std::ranges::transform(codes.first(width), row.begin(), [&](Code code) { return pixel_of[code]; });
        png.add_row(row);
    }
    return png.finish();
}

} // namespace

Bytes palette_png(std::span<const Code> codes, std::int32_t width, std::int32_t height, const LayerStyle& style) {
    assert(codes.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::array<bool, 256> occurs{};
    for (const Code code : codes) occurs[code] = true;
    std::vector<PaletteEntry> palette;
    PixelOfCode pixel_of{};
    for (std::size_t code = 0; code < occurs.size(); ++code) {
        if (!occurs[code]) continue;
        pixel_of[code] = static_cast<std::uint8_t>(palette.size());
        palette.push_back({style.palette[code]});
    }
    PngWriter png(width, height, palette);
    return written(png, codes, static_cast<std::size_t>(width), pixel_of);
}

Bytes grey_png(std::span<const Code> codes, std::int32_t width, std::int32_t height, const LayerStyle& style) {
    assert(codes.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) && style.is_grey);
    PixelOfCode pixel_of{};
    std::ranges::transform(style.palette, pixel_of.begin(), &Colour::red);
    PngWriter png(width, height);
    return written(png, codes, static_cast<std::size_t>(width), pixel_of);
}

} // namespace scanloom::tiles
