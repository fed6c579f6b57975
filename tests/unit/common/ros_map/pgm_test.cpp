#include "common/ros_map/pgm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

TEST(RosPgm, GreysAreClassifiedByThresholds) {
    const RosMapDescription plain{.free_thresh = 0.25};
    const auto image = bytes_of("P2\n# a comment\n6 1\n255\n0 100 150 205 206 254\n");
    using enum MapCell;
    EXPECT_THAT(read_ros_pgm(plain, image)->cells,
                testing::ElementsAre(kOccupied, kUnknown, kUnknown, kUnknown, kFree, kFree));
    auto scale = plain;
    scale.mode = RosMapMode::kScale;
    EXPECT_EQ(read_ros_pgm(scale, image)->cells[3], kFree);
    auto negated = plain;
    negated.negate = true;
    EXPECT_THAT(read_ros_pgm(negated, image)->cells,
                testing::ElementsAre(kFree, kUnknown, kUnknown, kUnknown, kOccupied, kOccupied));
}

/// Returns the cells as a plain or binary image with the greys 0, white / 2 and white.
std::string image_of(const MapCells& map, bool is_plain, int white) {
    const int greys[] = {white / 2, white, 0};
    std::string file = is_plain ? "P2" : "P5";
    file += " # how " + std::to_string(white) + "\n# 7 7 7\n" + std::to_string(map.width) + "#\n\t" +
            std::to_string(map.height()) + "\r\n" + std::to_string(white) + "\n";
    for (std::size_t row = map.height(); row-- > 0;) {
        for (std::size_t column = 0; column < map.width; ++column) {
            const int grey = greys[static_cast<int>(map.cells[row * map.width + column])];
            if (is_plain) {
                file += std::to_string(grey) + (column % 3 == 0 ? " # a comment\n" : " ");
            } else {
                if (white > 255) file += static_cast<char>(grey >> 8);
                file += static_cast<char>(grey & 0xFF);
            }
        }
    }
    return file;
}

TEST(RosPgm, PlainAndBinaryFilesOfAnyDepthGiveEqualCells) {
    std::mt19937 random(3);
    for (const int white : {2, 100, 255, 256, 1000, 65535}) {
        for (const bool is_plain : {false, true}) {
            MapCells map{1 + random() % 40, {}};
            map.cells.resize(map.width * (1 + random() % 30));
            for (MapCell& cell : map.cells) cell = static_cast<MapCell>(random() % 3);
            const auto read = read_ros_pgm({}, bytes_of(image_of(map, is_plain, white)));
            ASSERT_TRUE(read) << white << ' ' << read.error().message;
            EXPECT_EQ(read->width, map.width);
            EXPECT_EQ(read->cells, map.cells) << white << ' ' << is_plain;
        }
    }
}

TEST(RosPgm, BinaryPixelsMayLookLikeSpacesOrComments) {
    const RosMapDescription scale{.mode = RosMapMode::kScale};
    const auto read = read_ros_pgm(scale, bytes_of("P5 3 1 255\n\n# "));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->cells.size(), 3U);
}

TEST(RosPgm, RefusesInvalidImages) {
    for (const std::string& image :
         {std::string("P5 2 2 255 abcd"), std::string("P2 2 2 9 1 2 3 4"), std::string("P5 1 2 65535 abcd")}) {
        EXPECT_TRUE(read_ros_pgm({}, bytes_of(image))) << image;
        for (std::size_t size = 0; size + 1 < image.size(); ++size) {
            const auto refused = read_ros_pgm({}, bytes_of(image.substr(0, size)));
            ASSERT_FALSE(refused) << image.substr(0, size);
            EXPECT_EQ(refused.error().code, Errc::kMalformed);
        }
    }
    for (const auto& [image, why] :
         std::initializer_list<std::pair<const char*, const char*>>{{"P6 2 2 255 abcdabcdabcd", "not a PGM"},
                                                                    {"P5 0 2 255 ", "0 x 2"},
                                                                    {"P5 -2 2 255 abcd", "-2 x 2"},
                                                                    {"P5 2 2 0 abcd", "maxval"},
                                                                    {"P5 2 2 65536 abcdabcd", "maxval"},
                                                                    {"P5 2 2 -1 abcd", "maxval"},
                                                                    {"P5 2 2 255abcde", "white space"},
                                                                    {"P5 1 1 96 a", "a grey of 97"},
                                                                    {"P2 2 1 9 1 10", "a grey of 10"},
                                                                    {"P2 2 1 9 1 -1", "a grey of -1"},
                                                                    {"P2 2 1 9 1 x", "ends before"}}) {
        const auto refused = read_ros_pgm({}, bytes_of(image));
        ASSERT_FALSE(refused) << image;
        EXPECT_EQ(refused.error().code, Errc::kMalformed) << image;
        EXPECT_THAT(refused.error().message, HasSubstr(why));
    }
    for (const char* image : {"P5 8001 8000 255 a", "P5 000000000130000 8000 255 a", "P5 2000000000 2000000000 255 a",
                              "P2 1000001 1 255 1"}) {
        EXPECT_EQ(read_ros_pgm({}, bytes_of(image)).error().code, Errc::kTooLarge) << image;
    }
}

TEST(RosPgm, WritesTheHeaderOfMapSaver) {
    EXPECT_EQ(ros_pgm_header(604, 307, 0.05), "P5\n# CREATOR: Scanloom 0.050 m/pix\n604 307\n255\n");
}

} // namespace
} // namespace scanloom
