#include "server/tiles/ros_map_import.hpp"

#include "common/ros_map/description.hpp"
#include "core/mapping/projection.hpp"
#include "server/tiles/map_files.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/png_reader.hpp"
#include "tests/support/random_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace scanloom::tiles {
namespace {

using mapping::Layer;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// The maps of a session that begins with these patches.
mapping::Snapshot imported(const std::vector<MapPatch>& patches, double cell_size) {
    mapping::Projection projection(mapping::resolve({.cell_size = cell_size}).value());
    for (const auto& patch : patches) EXPECT_TRUE(projection.apply(patch));
    return projection.snapshot();
}

TEST(RosMapImport, RestoresAnExportedMap) {
    std::mt19937 random(41);
    testing_support::HandMadeMap map;
    for (std::int32_t j = -33; j < 80; ++j) {
        for (std::int32_t i = -120; i < 17; ++i) map.set({i, j}, testing_support::random_cell(random));
    }
    const auto snapshot = map.snapshot(1, {.cell_size = 0.05});
    const auto frame = map_frame(snapshot, Layer::kOccupancy, {}).value();
    const auto pgm = map_pgm(render_map(snapshot, Layer::kOccupancy, frame), snapshot.config);
    const auto description = parse_ros_yaml(map_yaml(frame)).value();
    const auto again = imported(read_ros_image(description, pgm).value(), 0.05);
    const auto same = map_pgm(render_map(again, Layer::kOccupancy, frame), again.config);
    EXPECT_TRUE(pgm == same);
    EXPECT_TRUE(pgm == map_pgm(render_map(again, Layer::kHimm, frame), again.config));
    EXPECT_EQ(again.robots.size(), 0U);
}

TEST(RosMapImport, ReadsRowsFromTheBottomInPatchesOfWholeRows) {
    cv::Mat image(1500, 1000, CV_8UC1, cv::Scalar(205));
    image.at<std::uint8_t>(0, 0) = 0;        // the top left pixel
    image.at<std::uint8_t>(1499, 999) = 254; // the bottom right one
    Bytes png;
    ASSERT_TRUE(cv::imencode(".png", image, png));
    const RosMapDescription description{.resolution = 0.1, .origin_x = -50.0, .origin_y = 20.0};
    const auto patches = read_ros_image(description, png).value();
    std::size_t rows = 0;
    for (const auto& patch : patches) {
        EXPECT_EQ(patch.width, 1000U);
        EXPECT_LE(patch.cells.size(), kMapPatchCellsMax);
        EXPECT_DOUBLE_EQ(patch.min_y, 20.0 + 0.1 * static_cast<double>(rows));
        rows += patch.height();
    }
    EXPECT_EQ(rows, 1500U);
    EXPECT_GT(patches.size(), 1U);
    EXPECT_EQ(patches.front().cells[999], MapCell::kFree);
    EXPECT_EQ(patches.back().cells[(patches.back().height() - 1) * 1000], MapCell::kOccupied);
    const auto map = imported(patches, 0.1);
    EXPECT_EQ(mapping::bounds_of(map, Layer::kOccupancy), (grid::CellBox{-500, 200, 500, 1700}));
}

/// OpenCV's decoder is the oracle. Colours may differ by one level, which libpng rounds in another way.
TEST(RosMapImport, ReadsEachKindOfPngAsGrey) {
    std::mt19937 random(7);
    for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3, CV_16UC3, CV_8UC4}) {
        cv::Mat image(37, 53, type);
        for (int n = 0; n < static_cast<int>(image.total() * image.elemSize()); ++n) {
            image.data[n] = static_cast<std::uint8_t>(random());
        }
        Bytes png;
        ASSERT_TRUE(cv::imencode(".png", image, png));
        const auto read = read_png(png).value();
        const cv::Mat expected = cv::imdecode(png, cv::IMREAD_GRAYSCALE);
        ASSERT_EQ(read.pixels.size(), expected.total());
        const bool is_coloured = image.channels() > 1;
        for (std::size_t n = 0; n < read.pixels.size(); ++n) {
            ASSERT_NEAR(read.pixels[n], expected.data[n], is_coloured ? 1 : 0) << "type " << type << ", pixel " << n;
        }
        for (std::size_t size = 0; size < png.size() * 9 / 10; size += 1 + png.size() / 50) {
            EXPECT_FALSE(read_png(std::span(png).first(size))) << "cut short";
        }
        png[png.size() / 2] ^= 1;
        EXPECT_EQ(read_png(png).error().code, Errc::kMalformed) << "a checksum does not match";
    }
}

TEST(RosMapImport, KeepsWallsAtOtherCellSizes) {
    const Bytes image = bytes_of("P2\n8 4\n255\n254 254 254 0 254 254 254 254\n254 254 254 254 254 254 254 254\n"
                                 "254 254 254 254 254 254 254 254\n254 254 254 254 254 254 254 254\n");
    const auto patches = read_ros_image({.resolution = 0.05}, image).value();
    const auto occupied = [&](double cell_size) {
        const auto map = imported(patches, cell_size);
        const auto drawn = render_map(map, Layer::kClassification, map_frame(map, Layer::kOccupancy, {}).value());
        return std::pair(std::ranges::count(drawn.codes, 2), drawn.codes.size());
    };
    EXPECT_EQ(occupied(0.05), (std::pair{1L, 32UL}));
    EXPECT_EQ(occupied(0.1), (std::pair{1L, 8UL}));
    EXPECT_EQ(occupied(0.2), (std::pair{1L, 2UL}));
    EXPECT_EQ(occupied(0.025), (std::pair{4L, 128UL}));
}

TEST(RosMapImport, RejectsInvalidImages) {
    const std::string pgm = "P5 2 2 255 abcd";
    for (std::size_t size = 0; size < pgm.size(); ++size) {
        EXPECT_FALSE(read_ros_image({}, bytes_of(pgm.substr(0, size)))) << size;
    }
    for (const char* image : {"P6 2 2 255 abcdabcdabcd", "P5 0 2 255 ", "P5 -2 2 255 abcd", "P5 x", "GIF89a"}) {
        EXPECT_EQ(read_ros_image({}, bytes_of(image)).error().code, Errc::kMalformed) << image;
    }
    for (const char* image : {"P5 8001 8000 255 abcd", "P5 000000000130000 8000 255 a",
                              "P5 2000000000 2000000000 255 a", "P5 1000001 1 255 a"}) {
        EXPECT_EQ(read_ros_image({}, bytes_of(image)).error().code, Errc::kTooLarge) << image;
    }
    Bytes png = bytes_of("\x89PNG\r\n\x1A\n");
    png.resize(40, 0xFF);
    EXPECT_FALSE(read_ros_image({}, png));
}

class RealMap : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Maps, RealMap, testing::Values("depot/depot", "turtlebot3_world/map"),
                         [](const auto& tried) { return std::string(tried.index == 0 ? "depot" : "turtlebot3"); });

TEST_P(RealMap, ImportsFreeOccupiedAndUnknownCells) {
    const auto base = std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/maps" / GetParam();
    const auto file = [&](const char* extension) {
        std::ifstream in(base.string() + extension, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    if (!std::filesystem::exists(base.string() + ".pgm"))
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << base;
    const auto description = parse_ros_yaml(file(".yaml"));
    ASSERT_TRUE(description) << description.error().message;
    const auto patches = read_ros_image(*description, bytes_of(file(".pgm")));
    ASSERT_TRUE(patches) << patches.error().message;
    const auto map = imported(*patches, description->resolution);
    const auto drawn = render_map(map, Layer::kClassification, map_frame(map, Layer::kOccupancy, {}).value());
    for (const auto code : {0, 1, 2, 4}) EXPECT_GT(std::ranges::count(drawn.codes, code), 100) << code;
}

} // namespace
} // namespace scanloom::tiles
