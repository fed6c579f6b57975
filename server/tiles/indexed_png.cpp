#include "server/tiles/indexed_png.hpp"

#include <zlib.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <new>
#include <string_view>

namespace scanloom::tiles {
namespace {

constexpr int kCompression = 3; // as in png.cpp
constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

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

Bytes header_of(std::int32_t width, std::int32_t height) {
    Bytes header;
    append_number(header, static_cast<std::uint32_t>(width));
    append_number(header, static_cast<std::uint32_t>(height));
    constexpr std::array<std::uint8_t, 5> kPalette8{8, 3, 0, 0, 0}; // 8 bits, a palette; not interlaced
    header.insert(header.end(), kPalette8.begin(), kPalette8.end());
    return header;
}

} // namespace

/// The pixels' stream, in IDAT chunks.
struct IndexedPng::Deflate {
    explicit Deflate(Bytes& to) : png(to) {
        if (deflateInit(&stream, kCompression) != Z_OK) throw std::bad_alloc();
    }
    ~Deflate() { deflateEnd(&stream); }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;

    void add(std::span<const std::uint8_t> bytes, int flush) {
        stream.next_in = const_cast<Bytef*>(bytes.data()); // which zlib does not write to
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
    std::array<std::uint8_t, kPieceBytes> piece{};
    std::size_t filled = 0;
};

IndexedPng::IndexedPng(std::int32_t width, std::int32_t height, std::span<const PaletteEntry> palette)
    : png_{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}, deflate_(std::make_unique<Deflate>(png_)) {
    assert(!palette.empty() && palette.size() <= 256);
    Bytes colours;
    Bytes opacities;
    for (const auto& [colour, opacity] : palette) {
        colours.insert(colours.end(), {colour.red, colour.green, colour.blue});
        opacities.push_back(opacity);
    }
    append_chunk(png_, "IHDR", header_of(width, height));
    append_chunk(png_, "PLTE", colours);
    append_chunk(png_, "tRNS", opacities);
}

IndexedPng::~IndexedPng() = default;

void IndexedPng::add_row(std::span<const std::uint8_t> pixels) {
    constexpr std::array<std::uint8_t, 1> kUnfiltered{0};
    deflate_->add(kUnfiltered, Z_NO_FLUSH);
    deflate_->add(pixels, Z_NO_FLUSH);
}

Bytes IndexedPng::finish() {
    deflate_->add({}, Z_FINISH);
    deflate_->write();
    append_chunk(png_, "IEND", {});
    return std::move(png_);
}

} // namespace scanloom::tiles
