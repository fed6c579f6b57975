#include "server/tiles/png.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <new>
#include <string_view>

namespace scanloom::tiles {
namespace {

constexpr int kWindowBits = 15; // a smaller window makes zlib slower because it moves more often
constexpr int kMemoryLevel = 8;
constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

constexpr std::uint8_t kGrey = 0; // colour types
constexpr std::uint8_t kColourTypePalette = 3;
constexpr std::uint8_t kUnfiltered = 0;

void append_number(Bytes& to, std::uint32_t number) {
    for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::uint8_t>(number >> shift));
}

void append_chunk(Bytes& png, std::string_view type, std::span<const std::uint8_t> data) {
    append_number(png, static_cast<std::uint32_t>(data.size()));
    const std::size_t checked = png.size();
    png.insert(png.end(), type.begin(), type.end());
    png.insert(png.end(), data.begin(), data.end());
    const auto check = crc32_z(0, png.data() + checked, png.size() - checked);
    append_number(png, static_cast<std::uint32_t>(check));
}

/// Starts the file: signature and IHDR.
Bytes beginning_of(std::int32_t width, std::int32_t height, int bits, std::uint8_t colour_type) {
    Bytes header;
    append_number(header, static_cast<std::uint32_t>(width));
    append_number(header, static_cast<std::uint32_t>(height));
    const std::array<std::uint8_t, 5> rest{static_cast<std::uint8_t>(bits), colour_type, 0, 0, 0}; // not interlaced
    header.insert(header.end(), rest.begin(), rest.end());
    Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    append_chunk(png, "IHDR", header);
    return png;
}

void append_palette(Bytes& png, std::span<const PaletteEntry> palette) {
    Bytes colours;
    Bytes opacities;
    for (const auto& [colour, opacity] : palette) {
        colours.insert(colours.end(), {colour.red, colour.green, colour.blue});
        opacities.push_back(opacity);
    }
    append_chunk(png, "PLTE", colours);
    const bool is_opaque = std::ranges::all_of(opacities, [](std::uint8_t opacity) { return opacity == 255; });
    if (!is_opaque) append_chunk(png, "tRNS", opacities);
}

int bits_for(std::size_t colours) noexcept {
    for (const int bits : {1, 2, 4}) {
        if (colours <= std::size_t{1} << bits) return bits;
    }
    return 8;
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

std::size_t packed_size(std::int32_t width, int bits) noexcept {
    return (static_cast<std::size_t>(width) * static_cast<std::size_t>(bits) + 7) / 8;
}

} // namespace

/// The compressed pixels, in IDAT chunks.
struct PngWriter::Deflate {
    explicit Deflate(Bytes& to) : png(to) {
        const int result = deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_RLE);
        if (result != Z_OK) throw std::bad_alloc();
    }
    ~Deflate() { deflateEnd(&stream); }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;

    void add(std::span<const std::uint8_t> bytes, int flush) {
        stream.next_in = const_cast<Bytef*>(bytes.data()); // zlib does not write to it
        stream.avail_in = static_cast<uInt>(bytes.size());
        int result = Z_OK;
        do {
            if (filled == piece.size()) write();
            stream.next_out = piece.data() + filled;
            stream.avail_out = static_cast<uInt>(piece.size() - filled);
            result = deflate(&stream, flush);
            filled = piece.size() - stream.avail_out;
        } while (flush == Z_FINISH ? result != Z_STREAM_END : stream.avail_in > 0);
    }

    void write() {
        if (filled > 0) append_chunk(png, "IDAT", std::span(piece).first(filled));
        filled = 0;
    }

    Bytes& png;
    z_stream stream{};
    std::array<std::uint8_t, kPieceBytes> piece;
    std::size_t filled = 0;
};

PngWriter::PngWriter(std::int32_t width, std::int32_t height)
    : png_(beginning_of(width, height, 8, kGrey)), bits_(8), packed_(1 + packed_size(width, bits_), kUnfiltered),
      deflate_(std::make_unique<Deflate>(png_)) {}

PngWriter::PngWriter(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette)
    : png_(beginning_of(width, height, bits_for(palette.size()), kColourTypePalette)), bits_(bits_for(palette.size())),
      packed_(1 + packed_size(width, bits_), kUnfiltered), deflate_(std::make_unique<Deflate>(png_)) {
    assert(!palette.empty() && palette.size() <= 256);
    append_palette(png_, palette);
}

PngWriter::~PngWriter() = default;

void PngWriter::add_row(std::span<const std::uint8_t> pixels) {
    std::uint8_t* to = packed_.data() + 1;
    switch (bits_) {
    case 1: pack<1>(pixels, to); break;
    case 2: pack<2>(pixels, to); break;
    case 4: pack<4>(pixels, to); break;
    default: std::ranges::copy(pixels, to);
    }
    deflate_->add(packed_, Z_NO_FLUSH);
}

Bytes PngWriter::finish() {
    deflate_->add({}, Z_FINISH);
    deflate_->write();
    append_chunk(png_, "IEND", {});
    return std::move(png_);
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
