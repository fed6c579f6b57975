#include "server/tiles/difference.hpp"

#include "core/mapping/projection.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

namespace scanloom::tiles {
namespace {

using mapping::Layer;
using mapping::Snapshot;

/// What a robot with a laser and sonars sees, under some settings.
Snapshot maps_of(const SessionOptions& options, std::uint64_t scans) {
    mapping::Projection projection(mapping::resolve(options).value());
    Sensor ring = testing_support::small_laser();
    ring.id = 3;
    ring.kind = SensorKind::kSonar;
    EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, testing_support::small_laser()}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, ring}));
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        Scan scan = testing_support::random_scan(5, seq);
        if (seq % 2 == 0) scan.sensor = ring.id;
        EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
    }
    return projection.snapshot();
}

/// The definition, cell by cell and with whole millimetres.
class Oracle {
public:
    Oracle(const ComparedMaps& maps, const MapFrame& frame) : maps_(maps), frame_(frame) {}

    /// 'u' unknown, 'f' free, 'o' occupied, '?' undecided; and the probability, where the layer has one.
    [[nodiscard]] std::pair<char, double> in(const Snapshot& map, grid::Cell place) const {
        const grid::Cell cell{own(map, place.i), own(map, place.j)};
        const auto& config = map.config;
        if (maps_.layer == Layer::kClassification) {
            switch (testing_support::class_at(map, cell)) {
            case classify::CellClass::kOccupied: return {'o', 0.0};
            case classify::CellClass::kFree:
            case classify::CellClass::kDanger: return {'f', 0.0};
            default: return {'u', 0.0};
            }
        }
        if (maps_.layer == Layer::kHimm) {
            const int count = testing_support::himm_at(map, cell);
            if (count == 255) return {'u', 0.0};
            return {count >= config.class_himm_occupied ? 'o' : count <= config.class_himm_free ? 'f' : '?', 0.0};
        }
        const auto l = maps_.layer == Layer::kSonar ? testing_support::sonar_at(map, cell)
                                                    : testing_support::occupancy_at(map, cell);
        if (l == mapping::kUnknownLogOdds) return {'u', 0.0};
        const double p = 1.0 / (1.0 + std::exp(-l / 2048.0));
        const double half_a_step = 0.5 / 2048.0 / 4.0; // thresholds are rounded as values are
        return {p >= config.class_p_occupied - half_a_step ? 'o'
                : p <= config.class_p_free + half_a_step   ? 'f'
                                                           : '?',
                p};
    }

private:
    [[nodiscard]] std::int32_t own(const Snapshot& map, std::int32_t index) const {
        const auto millimetres = [](double metres) { return std::lround(metres * 1000.0); };
        const std::int64_t twice = (2 * std::int64_t{index} + 1) * millimetres(frame_.cell_size);
        const std::int64_t size = 2 * millimetres(map.config.cell_size);
        return static_cast<std::int32_t>(twice >= 0 ? twice / size : -((-twice + size - 1) / size));
    }

    const ComparedMaps& maps_;
    const MapFrame& frame_;
};

std::string named(Difference difference) { return std::string(kDifferenceNames[static_cast<std::size_t>(difference)]); }

std::string name_of(char a, char b) {
    if (a == 'u') return b == 'u' ? "neither" : "only_b";
    if (b == 'u') return "only_a";
    if (a == '?' || b == '?') return "undecided";
    if (a == b) return a == 'f' ? "both_free" : "both_occupied";
    return a == 'f' ? "free_occupied" : "occupied_free";
}

using Pair = std::tuple<Layer, double, double>; // cell sizes

class DifferenceOf : public testing::TestWithParam<Pair> {};

std::string name_of_pair(const testing::TestParamInfo<Pair>& tried) {
    const auto [layer, a, b] = tried.param;
    return std::string(mapping::name_of(layer)) + std::to_string(std::lround(a * 100)) + "to" +
           std::to_string(std::lround(b * 100));
}

INSTANTIATE_TEST_SUITE_P(All, DifferenceOf,
                         testing::Combine(testing::ValuesIn(mapping::kLayers), testing::Values(0.05, 0.1),
                                          testing::Values(0.05, 0.1, 0.15)),
                         name_of_pair);

TEST_P(DifferenceOf, ClassifiesEachPlaceByTheCellsOfBothMaps) {
    const auto [layer, size_a, size_b] = GetParam();
    const auto a = maps_of({.cell_size = size_a, .danger_radius = 0.3}, 40);
    const auto b =
        maps_of({.cell_size = size_b, .class_p_occupied = 0.7, .class_himm_occupied = 7, .danger_radius = 0.3}, 60);
    const ComparedMaps maps{a, b, layer};
    const auto frame = difference_frame(maps, Extent{-9.0, -10.0, 9.5, 8.7}).value();
    EXPECT_EQ(frame.cell_size, std::min(size_a, size_b));
    const Oracle oracle(maps, frame);
    DifferenceSums expected;
    std::int32_t j = frame.cells.j_end;
    const auto sums = compare(maps, frame, [&](std::span<const Difference> row) {
        --j;
        ASSERT_EQ(row.size(), frame.pixels_wide());
        for (std::size_t n = 0; n < row.size(); ++n) {
            const grid::Cell place{frame.cells.i_begin + static_cast<std::int32_t>(n), j};
            const auto [says_a, p_a] = oracle.in(a, place);
            const auto [says_b, p_b] = oracle.in(b, place);
            ASSERT_EQ(named(row[n]), name_of(says_a, says_b)) << place.i << ", " << place.j;
            ++expected.cells[static_cast<std::size_t>(row[n])];
            if (says_a == 'u' || says_b == 'u') continue;
            ++expected.known;
            expected.agreeing += says_a == says_b ? 1 : 0;
            expected.difference += std::abs(p_a - p_b);
        }
    });
    EXPECT_EQ(j, frame.cells.j_begin);
    EXPECT_EQ(sums.cells, expected.cells);
    EXPECT_EQ(sums.known, expected.known);
    EXPECT_EQ(sums.agreeing, expected.agreeing);
    EXPECT_NEAR(sums.difference, expected.difference, 1e-6 * expected.difference);
    EXPECT_GT(sums.cells[static_cast<std::size_t>(Difference::kBothFree)], 1000U);
}

TEST(Difference, CoversBothMaps) {
    const auto few = maps_of({.cell_size = 0.1}, 3);
    const auto many = maps_of({.cell_size = 0.05}, 30);
    const auto blank = maps_of({.cell_size = 0.02}, 0);
    const auto cells = difference_frame({few, many}, std::nullopt).value().cells;
    auto all = mapping::bounds_of(many, Layer::kOccupancy);
    const auto coarse = mapping::bounds_of(few, Layer::kOccupancy);
    all.include({2 * coarse.i_begin, 2 * coarse.j_begin, 2 * coarse.i_end, 2 * coarse.j_end});
    EXPECT_EQ(cells, all);
    EXPECT_EQ(difference_frame({blank, few}, std::nullopt).value().cells.width(), 5 * coarse.width());
    EXPECT_EQ(difference_frame({blank, blank}, std::nullopt).error().code, Errc::kNotFound);
    EXPECT_EQ(difference_frame({few, many}, Extent{0, 0, 1000, 1000}).error().code, Errc::kTooLarge);
    EXPECT_EQ(difference_frame({few, many}, Extent{0, 0, 0, 1}).error().code, Errc::kInvalidField);
}

TEST(Difference, PngHasPaletteIndicesAndIsTransparentWhereUnknown) {
    const auto a = maps_of({.cell_size = 0.1}, 20);
    const auto b = maps_of({.cell_size = 0.05}, 30);
    const ComparedMaps maps{a, b};
    const auto frame = difference_frame(maps, std::nullopt).value();
    const auto png = difference_png(maps, frame);
    ASSERT_GT(png.size(), 26U);
    EXPECT_EQ(png[25], 3) << "the colour type of palettes";
    const cv::Mat image = cv::imdecode(png, cv::IMREAD_UNCHANGED); // blue, green, red, opacity
    ASSERT_EQ(image.type(), CV_8UC4);
    ASSERT_EQ(image.cols, frame.width());
    ASSERT_EQ(image.rows, frame.height());
    int y = 0;
    compare(maps, frame, [&](std::span<const Difference> row) {
        for (int x = 0; x < image.cols; ++x) {
            const auto pixel = image.at<cv::Vec4b>(y, x);
            const auto difference = row[static_cast<std::size_t>(x)];
            ASSERT_EQ(pixel[3], difference == Difference::kNeither ? 0 : 255);
            const bool is_blue = pixel[0] > pixel[2];
            const bool is_orange = pixel[2] > pixel[0];
            ASSERT_EQ(is_blue, difference == Difference::kOnlyA || difference == Difference::kOccupiedFree);
            ASSERT_EQ(is_orange, difference == Difference::kOnlyB || difference == Difference::kFreeOccupied);
        }
        ++y;
    });
    EXPECT_EQ(y, image.rows);
}

TEST(Difference, PngOfManyChunksIsComplete) {
    const auto a = maps_of({.cell_size = 0.01}, 60); // noise enough for more than a piece of 64 KiB
    const auto b = maps_of({.cell_size = 0.013}, 80);
    const ComparedMaps maps{a, b};
    const auto frame = difference_frame(maps, std::nullopt).value();
    const auto png = difference_png(maps, frame);
    EXPECT_GT(png.size(), std::size_t{70'000});
    const cv::Mat image = cv::imdecode(png, cv::IMREAD_UNCHANGED);
    EXPECT_EQ(image.rows, frame.height());
}

} // namespace
} // namespace scanloom::tiles
