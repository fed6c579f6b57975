#include "server/tiles/tile_key.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::tiles {
namespace {

using grid::Cell;
using grid::CellBox;

TEST(TileKey, NativePixelIsTheDocumentedCell) {
    for (const TileKey key : {TileKey{9, 0, 0}, TileKey{9, 256, 255}, TileKey{9, 255, 256}, TileKey{9, 511, 511}}) {
        const auto box = cells_of(key);
        EXPECT_EQ(box.width(), 256);
        EXPECT_EQ(box.height(), 256);
        EXPECT_EQ(box.i_begin, static_cast<std::int32_t>(256 * key.x) - 65536) << "px 0";
        EXPECT_EQ(box.j_end - 1, 65535 - static_cast<std::int32_t>(256 * key.y)) << "py 0";
    }
    EXPECT_EQ(cells_of({9, 256, 255}), (CellBox{0, 0, 256, 256})) << "right of and above the origin";
}

TEST(TileKey, TileCoversItsFourChildren) {
    for (std::uint32_t zoom = 0; zoom < kZoomNative; ++zoom) {
        const std::uint32_t last = (1U << zoom) - 1;
        for (const TileKey key : {TileKey{zoom, 0, 0}, TileKey{zoom, last, last / 2}, TileKey{zoom, last / 3, last}}) {
            const auto parent = cells_of(key);
            const auto top_left = cells_of({zoom + 1, 2 * key.x, 2 * key.y});
            const auto bottom_right = cells_of({zoom + 1, 2 * key.x + 1, 2 * key.y + 1});
            EXPECT_EQ(top_left.i_begin, parent.i_begin);
            EXPECT_EQ(top_left.j_end, parent.j_end);
            EXPECT_EQ(bottom_right.i_end, parent.i_end);
            EXPECT_EQ(bottom_right.j_begin, parent.j_begin);
            EXPECT_EQ(top_left.i_end, bottom_right.i_begin);
            EXPECT_EQ(top_left.j_begin, bottom_right.j_end);
        }
    }
}

TEST(TileKey, TileOfACellContainsIt) {
    std::mt19937 random(3);
    std::vector<Cell> cells{{0, 0}, {-1, -1}, {-65536, -65536}, {65535, 65535}, {-65536, 65535}, {255, 256}};
    for (int n = 0; n < 2000; ++n) {
        cells.push_back({static_cast<std::int32_t>(random() % 131072) - 65536,
                         static_cast<std::int32_t>(random() % 131072) - 65536});
    }
    for (const Cell cell : cells) {
        for (std::uint32_t zoom = 0; zoom <= kZoomNative; ++zoom) {
            const auto key = tile_of(cell, zoom);
            const auto box = cells_of(key);
            EXPECT_EQ(key.zoom, zoom);
            EXPECT_TRUE(box.i_begin <= cell.i && cell.i < box.i_end && box.j_begin <= cell.j && cell.j < box.j_end)
                << cell.i << ", " << cell.j << " at zoom " << zoom;
        }
    }
}

TEST(TileKey, ParsesAddressesOfTiles) {
    EXPECT_EQ(parse_tile_key("0", "0", "0").value(), (TileKey{0, 0, 0}));
    EXPECT_EQ(parse_tile_key("9", "511", "0").value(), (TileKey{9, 511, 0}));
    EXPECT_EQ(parse_tile_key("4", "10", "15").value(), (TileKey{4, 10, 15}));
}

TEST(TileKey, RejectsTextThatIsNotAWholeNumber) {
    using namespace std::string_view_literals;
    for (const auto text : {""sv, "-"sv, "-0"sv, "+5"sv, " 5"sv, "5 "sv, "05"sv, "-05"sv, "5.0"sv, "1e1"sv, "0x1"sv,
                            "five"sv, "5\0"sv, "\xC3\xA9"sv, "\xD9\xA1"sv, "--5"sv, "5-"sv, "nan"sv}) {
        for (const auto& parsed :
             {parse_tile_key(text, "1", "1"), parse_tile_key("1", text, "1"), parse_tile_key("77", "1", text)}) {
            ASSERT_FALSE(parsed) << text;
            EXPECT_EQ(parsed.error().code, Errc::kInvalidField) << text;
            EXPECT_THAT(parsed.error().message, testing::HasSubstr("whole number"));
        }
    }
    EXPECT_THAT(parse_tile_key("1", "1", "q").error().message, testing::StartsWith("tile y"));
}

TEST(TileKey, NumbersWithoutTileAreNotFound) {
    const std::string long_number(4000, '7');
    const std::array<const char*, 3> missing[] = {
        {"10", "0", "0"},         {"-1", "0", "0"}, {"4294967296", "0", "0"},
        {"0", "1", "0"},          {"0", "0", "1"},  {"9", "512", "0"},
        {"9", "0", "512"},        {"9", "-1", "0"}, {"9", "0", "18446744073709551616"},
        {"9", "4294967297", "0"}, {"3", "8", "7"},  {"3", long_number.c_str(), "7"}};
    for (const auto& [zoom, x, y] : missing) {
        const auto parsed = parse_tile_key(zoom, x, y);
        ASSERT_FALSE(parsed) << zoom << "/" << x << "/" << y;
        EXPECT_EQ(parsed.error().code, Errc::kNotFound) << zoom << "/" << x << "/" << y;
        EXPECT_LT(parsed.error().message.size(), 200U);
    }
    EXPECT_THAT(parse_tile_key("3", "8", "7").error().message, testing::HasSubstr("x must be from 0 to 7"));
}

} // namespace
} // namespace scanloom::tiles
