#pragma once

#include "server/tiles/bytes.hpp"
#include "server/tiles/layer_style.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace scanloom::tiles {

struct PaletteEntry {
    Colour colour;
    std::uint8_t opacity = 255; ///< 0 is clear
};

/// A PNG whose pixels are places in a palette, written row by row: no more of it is held than the file.
/// Source  ISO/IEC 15948:2004 (PNG), colour type 3, a byte a pixel.
class IndexedPng {
public:
    /// Pre  0 < width, height <= 1,000,000; 0 < palette.size() <= 256.
    IndexedPng(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette);
    ~IndexedPng();
    IndexedPng(const IndexedPng&) = delete;
    IndexedPng& operator=(const IndexedPng&) = delete;

    /// The next row from the top. Pre: `width` pixels, each below palette.size().
    void add_row(std::span<const std::uint8_t> pixels);

    /// Pre  all rows were added. Once.
    [[nodiscard]] Bytes finish();

private:
    struct Deflate;

    Bytes png_;
    std::unique_ptr<Deflate> deflate_;
};

} // namespace scanloom::tiles
