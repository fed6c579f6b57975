#pragma once

#include "server/tiles/bytes.hpp"
#include "server/tiles/layer_style.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

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
/// Source: ISO/IEC 15948:2004 (PNG), colour types 0 and 3; zlib's Z_RLE.
class PngWriter {
public:
    /// Starts an 8-bit grey image; a pixel is a grey level.
    /// @param width  pixels, 1..1,000,000; readers may reject more
    /// @param height  pixels, 1..1,000,000
    PngWriter(std::int32_t width, std::int32_t height);

    /// Starts an image with a palette; a pixel is an index into it, stored in 1, 2, 4 or 8 bits, as few as the
    /// palette's size needs.
    /// @param width  pixels, 1..1,000,000; readers may reject more
    /// @param height  pixels, 1..1,000,000
    /// @param palette  1..256 entries
    PngWriter(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette);

    ~PngWriter();
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    /// Adds the next row.
    /// @param pixels  `width` pixels; with a palette, each less than the palette's size
    void add_row(std::span<const std::uint8_t> pixels);

    /// Completes the file and returns it. Call once.
    /// Precondition: all rows have been added.
    [[nodiscard]] Bytes finish();

private:
    struct Deflate;

    Bytes png_;
    int bits_;     // of a pixel
    Bytes packed_; // the current row, filter type first
    std::unique_ptr<Deflate> deflate_;
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
