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
    std::uint8_t opacity = 255; ///< 0 is clear
};

/// A PNG written row by row from the top: no more of it is held than the file. The same rows are the same bytes.
///
/// Compressed as runs alone: maps are runs of equal cells and noise in between, in which longer matches are rare. That
/// is both faster and smaller here than the general search of zlib's lower levels.
/// Source  ISO/IEC 15948:2004 (PNG), colour types 0 and 3; zlib's Z_RLE.
class PngWriter {
public:
    /// 8-bit grey: a pixel is its grey.
    /// Pre  here and below: 0 < width, height <= 1,000,000, as readers may refuse more.
    PngWriter(std::int32_t width, std::int32_t height);

    /// Pixels are places in a palette, of 1, 2, 4 or 8 bits: as few as its size needs.
    /// Pre  0 < palette.size() <= 256.
    PngWriter(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette);

    ~PngWriter();
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    /// Pre  `width` pixels, with a palette each below its size.
    void add_row(std::span<const std::uint8_t> pixels);

    /// Pre  all rows were added. Once.
    [[nodiscard]] Bytes finish();

private:
    struct Deflate;

    Bytes png_;
    int bits_;     // of a pixel
    Bytes packed_; // the row under way, its filter first
    std::unique_ptr<Deflate> deflate_;
};

/// A PNG with a palette of the colours of those codes that occur, and so with few bits a pixel.
/// Shapes  width * height codes, top row first.
/// Pre     0 < width, height <= 1,000,000.
[[nodiscard]] Bytes palette_png(std::span<const Code> codes, std::int32_t width, std::int32_t height,
                                const LayerStyle& style);

/// 8-bit grey, which means something also to programs that read samples and look at no palette. As above.
/// Pre  style.is_grey.
[[nodiscard]] Bytes grey_png(std::span<const Code> codes, std::int32_t width, std::int32_t height,
                             const LayerStyle& style);

} // namespace scanloom::tiles
