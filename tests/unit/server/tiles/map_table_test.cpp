#include "server/tiles/map_table.hpp"

#include "server/tiles/layer_style.hpp"
#include "tests/support/pixel_oracle.hpp"
#include "tests/support/random_layers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::tiles {
namespace {

using mapping::Layer;

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin < text.size();) {
        const auto end = std::min(text.find(at, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

/// An array as NumPy would load it: NEP 1, format version 1.0.
struct NpyArray {
    std::string dtype;
    std::size_t rows = 0;
    std::size_t columns = 0;
    std::string data;

    [[nodiscard]] float float_at(std::size_t n) const {
        float value = 0.0F;
        std::memcpy(&value, data.data() + 4 * n, 4);
        return value;
    }
};

NpyArray load_npy(const Bytes& bytes) {
    static_assert(std::endian::native == std::endian::little);
    const std::string file(bytes.begin(), bytes.end());
    EXPECT_EQ(file.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t length = static_cast<unsigned char>(file[8]) + 256U * static_cast<unsigned char>(file[9]);
    EXPECT_EQ((10 + length) % 64, 0U) << "the data is aligned";
    const std::string header = file.substr(10, length);
    EXPECT_EQ(header.back(), '\n');
    EXPECT_THAT(header, testing::HasSubstr("'fortran_order': False"));
    NpyArray array;
    const auto after = [&](const char* key) { return header.substr(header.find(key) + std::strlen(key)); };
    array.dtype = after("'descr': '").substr(0, 3);
    EXPECT_EQ(std::sscanf(after("'shape': ").c_str(), "(%zu, %zu)", &array.rows, &array.columns), 2) << header;
    array.data = file.substr(10 + length);
    EXPECT_EQ(array.data.size(), array.rows * array.columns * (array.dtype == "<f4" ? 4 : 1));
    return array;
}

const std::vector<grid::CellBox> kBoxes = {
    {-70, -90, 75, 66}, {0, 0, 64, 64}, {5, 7, 6, 8}, {-400, 100, -330, 101}, {400, 400, 420, 410}};

class MapTableOf : public testing::TestWithParam<Layer> {};

INSTANTIATE_TEST_SUITE_P(AnyLayer, MapTableOf, testing::ValuesIn(mapping::kLayers),
                         [](const auto& tried) { return std::string(mapping::name_of(tried.param)); });

TEST_P(MapTableOf, TheCsvReadsBackAsTheCellsTopRowFirst) {
    const Layer layer = GetParam();
    const auto snapshot = testing_support::random_layers(51);
    for (const auto& box : kBoxes) {
        const std::string csv = map_csv(render_map(snapshot, layer, {box, 0.05}));
        EXPECT_EQ(csv.back(), '\n');
        const auto lines = split(csv, '\n');
        ASSERT_EQ(lines.size(), static_cast<std::size_t>(box.height()));
        for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
            const auto values = split(lines[static_cast<std::size_t>(box.j_end - 1 - j)], ',');
            ASSERT_EQ(values.size(), static_cast<std::size_t>(box.width()));
            for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
                const auto text = values[static_cast<std::size_t>(i - box.i_begin)];
                int value = -99;
                const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                ASSERT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
                const Code code = oracle::code_at(snapshot, layer, {i, j});
                ASSERT_EQ(value, code == 255 ? -1 : code) << i << ", " << j;
            }
        }
    }
}

TEST_P(MapTableOf, TheNpyReadsBackAsTheCellsTopRowFirst) {
    const Layer layer = GetParam();
    const bool is_probability = layer == Layer::kOccupancy || layer == Layer::kSonar;
    const auto snapshot = testing_support::random_layers(52);
    for (const auto& box : kBoxes) {
        const NpyArray array = load_npy(map_npy(snapshot, layer, {box, 0.05}));
        ASSERT_EQ(array.dtype, is_probability ? "<f4" : "|u1");
        EXPECT_EQ(npy_bytes_per_cell(layer), is_probability ? 4 : 1);
        ASSERT_EQ(array.rows, static_cast<std::size_t>(box.height()));
        ASSERT_EQ(array.columns, static_cast<std::size_t>(box.width()));
        std::size_t n = 0;
        for (std::int32_t j = box.j_end - 1; j >= box.j_begin; --j) {
            for (std::int32_t i = box.i_begin; i < box.i_end; ++i, ++n) {
                const Code code = oracle::code_at(snapshot, layer, {i, j});
                if (!is_probability) {
                    ASSERT_EQ(static_cast<Code>(array.data[n]), code) << i << ", " << j;
                } else if (code == 255) {
                    ASSERT_TRUE(std::isnan(array.float_at(n))) << i << ", " << j;
                } else {
                    ASSERT_NEAR(array.float_at(n), code / 100.0, 0.005001) << i << ", " << j;
                }
            }
        }
    }
}

TEST(MapNpy, HoldsProbabilitiesNotPercent) {
    testing_support::HandMadeMap map;
    map.set({0, 0}, 1268);
    map.set({1, 0}, -14145);
    const auto array = load_npy(map_npy(map.snapshot(), Layer::kOccupancy, {{0, 0, 3, 1}, 0.05}));
    EXPECT_FLOAT_EQ(array.float_at(0), static_cast<float>(1.0 / (1.0 + std::exp(-1268 / 2048.0))));
    EXPECT_FLOAT_EQ(array.float_at(1), static_cast<float>(1.0 / (1.0 + std::exp(14145 / 2048.0))));
    EXPECT_TRUE(std::isnan(array.float_at(2)));
}

TEST(MapCsv, IsExactlyThis) {
    EXPECT_EQ(map_csv({{{0, 0, 3, 2}, 0.05}, Layer::kOccupancy, {0, 7, 255, 100, 50, 1}}), "0,7,-1\n100,50,1\n");
    EXPECT_EQ(map_csv({{{0, 0, 3, 1}, 0.05}, Layer::kHimm, {15, 0, 255}}), "15,0,-1\n");
    EXPECT_EQ(map_csv({{{0, 0, 5, 1}, 0.05}, Layer::kClassification, {0, 1, 2, 3, 4}}), "0,1,2,3,4\n");
}

} // namespace
} // namespace scanloom::tiles
