#pragma once

#include "server/tiles/bytes.hpp"
#include "server/tiles/layer_style.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

struct spng_ctx;

namespace scanloom::tiles {

struct PaletteEntry {
    Colour colour;
    std::uint8_t opacity = 255; ///< 0 is transparent
};

/// Writes a PNG row by row from the top. Memory holds only the compressed file and the current row. The same rows give
/// the same bytes.
///
/// Compression finds runs only: maps consist of runs of equal cells with noise in between, in which longer matches are
/// rare. For maps, this is both faster and smaller than the general search of zlib's lower levels.
/// Source: ISO/IEC 15948:2004 (PNG), colour types 0 and 3; libspng with zlib's Z_RLE.
class PngWriter {
public:
    /// Starts an image. With a palette, a pixel is an index into it, stored in 1, 2, 4 or 8 bits, as few as the
    /// palette's size needs; without, a pixel is a grey level of 8 bits.
    /// @param width  pixels, 1..1,000,000; readers may reject more
    /// @param height  pixels, 1..1,000,000
    /// @param palette  at most 256 entries
    /// Errors: throws std::bad_alloc, as do the functions below.
    PngWriter(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette = {});

    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    /// Adds the next row.
    /// @param pixels  `width` pixels; with a palette, each less than the palette's size
    void add_row(std::span<const std::uint8_t> pixels);

    /// Completes the file and returns it. Call once.
    /// Precondition: all rows have been added.
    [[nodiscard]] Bytes finish() { return std::move(png_); }

private:
    struct FreeContext {
        void operator()(spng_ctx* context) const noexcept;
    };

    Bytes png_;
    int bits_;     // of a pixel
    Bytes packed_; // the current row
    std::unique_ptr<spng_ctx, FreeContext> context_;
};

/// Encodes codes as a PNG. The palette contains only the codes that occur, so that a pixel takes few bits.
/// @param codes  width * height codes, top row first
/// @param width  pixels, 1..1,000,000
/// @param height  pixels, 1..1,000,000
/// @param style  colours of the codes
[[nodiscard]] Bytes palette_png(std::span<const Code> codes, std::int32_t width, std::int32_t height,
                                const LayerStyle& style);

/// Encodes codes as an 8-bit grey PNG, for programs that read samples and ignore palettes.
/// @param codes  width * height codes, top row first
/// @param width  pixels, 1..1,000,000
/// @param height  pixels, 1..1,000,000
/// @param style  colours of the codes; style.is_grey
[[nodiscard]] Bytes grey_png(std::span<const Code> codes, std::int32_t width, std::int32_t height,
                             const LayerStyle& style);

} // namespace scanloom::tiles
