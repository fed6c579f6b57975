#include "server/tiles/map_image.hpp"

#include "core/mapping/projection.hpp"
#include "server/tiles/layer_style.hpp"
#include "tests/support/pixel_oracle.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/random_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scanloom::tiles {
namespace {

using grid::CellBox;

TEST(Extent, OfTilesIsSquareOf131072Cells) {
    EXPECT_EQ(tiled_extent(0.05), (Extent{-3276.8, -3276.8, 3276.8, 3276.8}));
}

TEST(Extent, CellsSurviveConversionToMetresAndBack) {
    for (const double cell_size : {0.01, 0.03, 0.05, 0.07, 0.1, 0.5, 1.0}) {
        for (std::int32_t i = -100'000; i < 100'000; i += 317) {
            const CellBox box{i, i / 2, i + 1 + std::abs(i) % 7, i / 2 + 3};
            ASSERT_EQ(cells_in(extent_of(box, cell_size), cell_size).value(), box) << cell_size;
        }
    }
}

TEST(Extent, ContainsEveryOverlappedCell) {
    EXPECT_EQ(cells_in({-0.05, 0.31, 0.05, 0.49}, 0.1).value(), (CellBox{-1, 3, 1, 5}));
    EXPECT_EQ(cells_in({0.3, 0.3, 0.7, 0.7}, 0.1).value(), (CellBox{3, 3, 7, 7})) << "decimal metres";
    EXPECT_EQ(cells_in({0.31, 0.31, 0.32, 0.32}, 0.1).value(), (CellBox{3, 3, 4, 4})) << "within one cell";
    const double border = 0.3;
    EXPECT_EQ(cells_in({border, border, std::nextafter(border, 1.0), 0.4}, 0.1)->width(), 1);
}

TEST(Extent, RejectsRectanglesWithoutCells) {
    const double nan = std::nan("");
    for (const Extent& bad : {Extent{0, 0, 0, 1}, Extent{0, 0, 1, 0}, Extent{1, 0, 0, 1}, Extent{0, 1, 1, 0},
                              Extent{nan, 0, 1, 1}, Extent{0, 0, 1, nan}, Extent{-HUGE_VAL, 0, 1, 1},
                              Extent{0, 0, 1, HUGE_VAL}, Extent{0, 0, 1e300, 1}, Extent{-6e7, 0, 1, 1}}) {
        const auto cells = cells_in(bad, 0.05);
        ASSERT_FALSE(cells);
        EXPECT_EQ(cells.error().code, Errc::kInvalidField);
        EXPECT_THAT(cells.error().message, testing::StartsWith("bbox"));
    }
}

using mapping::Layer;

using grid::CellBox;
using testing_support::HandMadeMap;

HandMadeMap small_random_map() {
    std::mt19937 random(21);
    HandMadeMap map;
    for (std::int32_t j = -150; j < 90; ++j) {
        for (std::int32_t i = -70; i < 201; ++i) map.set({i, j}, testing_support::random_cell(random));
    }
    return map;
}

std::uint8_t percent_at(const mapping::Snapshot& snapshot, grid::Cell cell) {
    const auto* chunk = snapshot.laser.find(grid::chunk_of(cell));
    if (chunk == nullptr) return kUnknownPercent;
    return percent_table()[static_cast<std::uint16_t>(chunk->occupancy[grid::index_in_chunk(cell)])];
}

void expect_equals_brute_force(const mapping::Snapshot& snapshot, const MapImage& image) {
    const auto& box = image.frame.cells;
    ASSERT_EQ(image.codes.size(), static_cast<std::size_t>(box.width() * box.height()));
    std::size_t n = 0;
    for (std::int32_t j = box.j_end - 1; j >= box.j_begin; --j) {
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i, ++n) {
            ASSERT_EQ(image.codes[n], percent_at(snapshot, {i, j})) << i << ", " << j;
        }
    }
}

TEST(MapImage, OfAnyLayerContainsEveryCell) {
    for (const auto source : {ClassSource::kOccupancy, ClassSource::kHimm}) {
        mapping::Projection projection(mapping::resolve({.cell_size = 0.1, .class_source = source}).value());
        Sensor sonar{.id = 9, .kind = SensorKind::kSonar, .angles = UniformAngles{0.0, 1.0, 6}, .range_max = 4.0};
        ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
        ASSERT_TRUE(projection.apply(SensorDescribed{0, testing_support::small_laser()}));
        ASSERT_TRUE(projection.apply(SensorDescribed{0, sonar}));
        for (Scan scan : testing_support::random_scans(3, 1, 8)) {
            if (scan.seq % 4 == 0) scan.sensor = 9;
            if (scan.seq % 4 == 0) scan.ranges.resize(6);
            ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        }
        const auto snapshot = projection.snapshot();
        for (const Layer layer : mapping::kLayers) {
            const auto frame = map_frame(snapshot, layer, {}).value();
            const auto image = render_map(snapshot, layer, frame);
            std::size_t known = 0;
            oracle::for_each_code(snapshot, layer, [&](std::int32_t i, std::int32_t j, oracle::Code code) {
                if (code == oracle::unknown_code(layer)) return;
                ++known;
                const auto& box = frame.cells;
                ASSERT_TRUE(box.i_begin <= i && i < box.i_end && box.j_begin <= j && j < box.j_end)
                    << mapping::name_of(layer) << " " << i << ", " << j;
                const auto n = static_cast<std::size_t>((box.j_end - 1 - j) * frame.width() + i - box.i_begin);
                ASSERT_EQ(image.codes[n], code) << mapping::name_of(layer) << " " << i << ", " << j;
            });
            EXPECT_GT(known, 1000U);
            EXPECT_EQ(static_cast<std::ptrdiff_t>(known),
                      std::ssize(image.codes) - std::ranges::count(image.codes, oracle::unknown_code(layer)));
        }
    }
}

TEST(MapImage, OfABoxHasItsSizeAndUnknownCells) {
    const auto snapshot = small_random_map().snapshot(1, {.cell_size = 0.1});
    for (const Extent& bbox : {Extent{-1, -2, 3, 4}, Extent{-0.1, -0.1, 0, 0}, Extent{-9, -20, 25, 15},
                               Extent{6.4, 0, 12.8, 6.4}, Extent{500, 500, 501, 502}}) {
        const auto frame = map_frame(snapshot, Layer::kOccupancy, bbox).value();
        EXPECT_EQ(frame.cells, cells_in(bbox, 0.1).value());
        expect_equals_brute_force(snapshot, render_map(snapshot, Layer::kOccupancy, frame));
    }
}

TEST(MapImage, IsDrawnOutsideTheTiledArea) {
    HandMadeMap map;
    map.set({-99'999'999, 99'999'990}, -14000);
    map.set({-99'999'990, 99'999'999}, 14000);
    const auto snapshot = map.snapshot();
    const auto image = render_map(snapshot, Layer::kOccupancy, map_frame(snapshot, Layer::kOccupancy, {}).value());
    EXPECT_EQ(image.frame.width(), 10);
    EXPECT_EQ(image.codes[9], 100) << "top right";
    EXPECT_EQ(image.codes[90], 0) << "bottom left";
    expect_equals_brute_force(snapshot, image);
}

TEST(MapImage, OfAnEmptyLayerIsNotFoundWithoutBbox) {
    const auto none = map_frame(mapping::Snapshot{}, Layer::kOccupancy, {});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, Errc::kNotFound);
    EXPECT_THAT(none.error().message, testing::HasSubstr("no map yet"));
    const auto place = map_frame(mapping::Snapshot{}, Layer::kOccupancy, Extent{0, 0, 1, 1}).value();
    EXPECT_THAT(render_map(mapping::Snapshot{}, Layer::kOccupancy, place).codes,
                testing::AllOf(testing::SizeIs(400), testing::Each(kUnknownPercent)));
}

TEST(MapImage, RejectsTooManyPixelsAndSuggestsBbox) {
    HandMadeMap map;
    map.set({0, 0}, 1);
    map.set({7'999, 7'999}, 1);
    EXPECT_TRUE(map_frame(map.snapshot(), Layer::kOccupancy, {})) << "64 million";
    map.set({8'000, 0}, 1);
    const auto refused = map_frame(map.snapshot(), Layer::kOccupancy, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kTooLarge);
    EXPECT_THAT(refused.error().message,
                testing::AllOf(testing::HasSubstr("8001 x 8000 pixels"), testing::HasSubstr("bbox=")));
    EXPECT_TRUE(map_frame(map.snapshot(), Layer::kOccupancy, Extent{0, 0, 5, 5}));
    EXPECT_EQ(map_frame(map.snapshot(), Layer::kOccupancy, Extent{-5e7, -5e7, 5e7, 5e7}).error().code, Errc::kTooLarge);
    EXPECT_EQ(map_frame(map.snapshot(), Layer::kOccupancy, Extent{0, 0, -1, 5}).error().code, Errc::kInvalidField);
}

TEST(MapImage, EncodesTheLongestAllowedSide) {
    const auto longest = map_frame(mapping::Snapshot{}, Layer::kOccupancy, Extent{0, 0, 50'000, 0.05});
    ASSERT_TRUE(longest);
    EXPECT_EQ(longest->width(), kMapSideMax);
    EXPECT_GT(map_png(render_map(mapping::Snapshot{}, Layer::kOccupancy, *longest)).size(), 100U);
    EXPECT_FALSE(map_frame(mapping::Snapshot{}, Layer::kOccupancy, Extent{0, 0, 0.05, 50'000.05}));
}

TEST(MapImage, PngHasTheGreysOfTheTiles) {
    const auto snapshot = small_random_map().snapshot();
    const auto image = render_map(snapshot, Layer::kOccupancy, map_frame(snapshot, Layer::kOccupancy, {}).value());
    const cv::Mat png = cv::imdecode(map_png(image), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(png.type(), CV_8UC1);
    ASSERT_EQ(png.size(), cv::Size(image.frame.width(), image.frame.height()));
    for (std::size_t n = 0; n < image.codes.size(); ++n) ASSERT_EQ(png.data[n], grey_of(image.codes[n]));
}

} // namespace
} // namespace scanloom::tiles
