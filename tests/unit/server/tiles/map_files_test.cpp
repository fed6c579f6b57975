#include "server/tiles/map_files.hpp"

#include "server/tiles/layer_style.hpp"
#include "tests/support/pixel_oracle.hpp"
#include "tests/support/random_layers.hpp"
#include "tests/support/random_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>
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

TEST_P(MapTableOf, CsvContainsTheCellsTopRowFirst) {
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

TEST_P(MapTableOf, NpyContainsTheCellsTopRowFirst) {
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

TEST(MapNpy, ContainsProbabilitiesNotPercentages) {
    testing_support::HandMadeMap map;
    map.set({0, 0}, 1268);
    map.set({1, 0}, -14145);
    const auto array = load_npy(map_npy(map.snapshot(), Layer::kOccupancy, {{0, 0, 3, 1}, 0.05}));
    EXPECT_FLOAT_EQ(array.float_at(0), static_cast<float>(1.0 / (1.0 + std::exp(-1268 / 2048.0))));
    EXPECT_FLOAT_EQ(array.float_at(1), static_cast<float>(1.0 / (1.0 + std::exp(14145 / 2048.0))));
    EXPECT_TRUE(std::isnan(array.float_at(2)));
}

TEST(MapCsv, HasTheDocumentedText) {
    EXPECT_EQ(map_csv({{{0, 0, 3, 2}, 0.05}, Layer::kOccupancy, {0, 7, 255, 100, 50, 1}}), "0,7,-1\n100,50,1\n");
    EXPECT_EQ(map_csv({{{0, 0, 3, 1}, 0.05}, Layer::kHimm, {15, 0, 255}}), "15,0,-1\n");
    EXPECT_EQ(map_csv({{{0, 0, 5, 1}, 0.05}, Layer::kClassification, {0, 1, 2, 3, 4}}), "0,1,2,3,4\n");
}

using mapping::Layer;

/// nav_msgs/OccupancyGrid as far as map servers fill it.
struct Grid {
    double resolution = 0.0;
    double origin_x = 0.0;
    double origin_y = 0.0;
    int width = 0;
    int height = 0;
    std::vector<int> data; ///< bottom row first: -1 unknown, 0 free, 100 occupied
};

enum class Server { kRos1, kNav2 };

/// What a map server makes of a pair of files in trinary mode.
class MapServer {
public:
    MapServer(const Bytes& pgm, const std::string& yaml) : pgm_(pgm.begin(), pgm.end()) {
        std::istringstream lines(yaml);
        for (std::string line; std::getline(lines, line);) {
            const auto colon = line.find(": ");
            keys_[line.substr(0, colon)] = line.substr(colon + 2);
        }
    }

    [[nodiscard]] Grid load(Server server) const {
        Grid grid;
        const auto pixels = read_pgm(grid.width, grid.height);
        grid.resolution = std::stod(keys_.at("resolution"));
        double yaw = 1.0;
        EXPECT_EQ(std::sscanf(keys_.at("origin").c_str(), "[%lf, %lf, %lf]", &grid.origin_x, &grid.origin_y, &yaw), 3);
        EXPECT_EQ(yaw, 0.0);
        EXPECT_EQ(keys_.at("mode"), "trinary");
        EXPECT_EQ(keys_.at("image"), "map.pgm");
        for (int row = grid.height - 1; row >= 0; --row) {
            for (int column = 0; column < grid.width; ++column) {
                grid.data.push_back(value_of(pixels[static_cast<std::size_t>(row * grid.width + column)], server));
            }
        }
        return grid;
    }

private:
    std::string read_pgm(int& width, int& height) const {
        std::istringstream in(pgm_);
        std::string magic;
        std::string comment;
        int depth = 0;
        std::getline(in, magic);
        std::getline(in, comment);
        in >> width >> height >> depth;
        EXPECT_EQ(magic, "P5");
        EXPECT_THAT(comment, testing::StartsWith("# CREATOR: "));
        EXPECT_EQ(depth, 255);
        EXPECT_EQ(in.get(), '\n');
        const auto pixels = pgm_.substr(static_cast<std::size_t>(in.tellg()));
        EXPECT_EQ(pixels.size(), static_cast<std::size_t>(width * height));
        return pixels;
    }

    [[nodiscard]] int value_of(char pixel, Server server) const {
        const double v = static_cast<unsigned char>(pixel);
        const double p = keys_.at("negate") == "1" ? v / 255.0 : (255.0 - v) / 255.0;
        const double occupied = std::stod(keys_.at("occupied_thresh"));
        const double free = std::stod(keys_.at("free_thresh"));
        if (server == Server::kRos1) return p > occupied ? 100 : p < free ? 0 : -1;
        return p >= occupied ? 100 : p <= free ? 0 : -1;
    }

    std::string pgm_;
    std::map<std::string, std::string> keys_;
};

TEST(RosMap, LoadsAsTheSameCellsInRos1AndNav2) {
    testing_support::HandMadeMap map;
    std::mt19937 random(31);
    for (std::int32_t j = -33; j < 80; ++j) {
        for (std::int32_t i = -120; i < 17; ++i) map.set({i, j}, testing_support::random_cell(random));
    }
    const auto snapshot = map.snapshot(1, {.cell_size = 0.05});
    const auto image = render_map(snapshot, Layer::kOccupancy, map_frame(snapshot, Layer::kOccupancy, {}).value());
    const MapServer files(map_pgm(image, snapshot.config), map_yaml(image.frame));

    for (const auto server : {Server::kRos1, Server::kNav2}) {
        const auto grid = files.load(server);
        EXPECT_DOUBLE_EQ(grid.resolution, 0.05);
        EXPECT_DOUBLE_EQ(grid.origin_x, -6.0);
        EXPECT_DOUBLE_EQ(grid.origin_y, -1.65);
        ASSERT_EQ(grid.width, 137);
        ASSERT_EQ(grid.height, 113);
        std::size_t counts[3] = {};
        for (std::int32_t n = 0; n < 137 * 113; ++n) {
            const grid::Cell cell{-120 + n % 137, -33 + n / 137};
            const auto l = snapshot.laser.find(grid::chunk_of(cell))->occupancy[grid::index_in_chunk(cell)];
            const double percent = std::round(100.0 * mapping::probability_of(l));
            const bool unknown = l == mapping::kUnknownLogOdds;
            const int expected = unknown ? -1 : percent >= 65 ? 100 : percent <= 35 ? 0 : -1;
            ASSERT_EQ(grid.data[static_cast<std::size_t>(n)], expected) << cell.i << ", " << cell.j;
            ++counts[expected == 100 ? 2 : expected + 1];
        }
        EXPECT_THAT(counts, testing::Each(testing::Gt(50U))) << "unknown, free and occupied were all tried";
        EXPECT_TRUE(std::ranges::equal(occupancy_grid(image, snapshot.config), grid.data));
    }
}

TEST(RosMap, GreysAreThoseOfMapSaver) {
    const MapImage image{{{0, 0, 6, 1}, 0.05}, Layer::kOccupancy, {0, 35, 36, 64, 65, 255}};
    const auto pgm = map_pgm(image, {});
    const std::string header = "P5\n# CREATOR: Scanloom 0.050 m/pix\n6 1\n255\n";
    ASSERT_EQ(std::string(pgm.begin(), pgm.end() - 6), header);
    EXPECT_EQ(Bytes(pgm.end() - 6, pgm.end()), (Bytes{254, 254, 205, 205, 0, 205}));
}

Bytes greys_of(Layer layer, const Bytes& codes, const mapping::MapConfig& config = {}) {
    const auto pgm = map_pgm({{{0, 0, static_cast<std::int32_t>(codes.size()), 1}, 0.05}, layer, codes}, config);
    return {pgm.end() - static_cast<std::ptrdiff_t>(codes.size()), pgm.end()};
}

TEST(RosMap, EveryLayerHasTheSameThreeGreys) {
    EXPECT_EQ(greys_of(Layer::kSonar, {0, 35, 36, 64, 65, 100, 255}), (Bytes{254, 254, 205, 205, 0, 0, 205}));
    EXPECT_EQ(greys_of(Layer::kClassification, {0, 1, 2, 3, 4}), (Bytes{205, 254, 0, 205, 254}));
    EXPECT_EQ(greys_of(Layer::kHimm, {0, 4, 5, 7, 8, 15, 255}), (Bytes{254, 254, 205, 205, 0, 0, 205}));
    mapping::MapConfig config;
    config.class_himm_occupied = 12;
    config.class_himm_free = 1;
    config.class_p_occupied = 0.58;
    config.class_p_free = 0.29;
    EXPECT_EQ(greys_of(Layer::kOccupancy, {0, 29, 30, 57, 58, 255}, config), (Bytes{254, 254, 205, 205, 0, 205}));
    EXPECT_EQ(greys_of(Layer::kHimm, {0, 1, 2, 11, 12, 255}, config), (Bytes{254, 254, 205, 205, 0, 205}));
}

TEST(RosMap, YamlHasTheDocumentedText) {
    EXPECT_EQ(map_yaml({{-101, 0, 10, 10}, 0.05}), "image: map.pgm\n"
                                                   "mode: trinary\n"
                                                   "resolution: 0.05\n"
                                                   "origin: [-5.05, 0, 0]\n"
                                                   "negate: 0\n"
                                                   "occupied_thresh: 0.65\n"
                                                   "free_thresh: 0.196\n");
}

TEST(WorldFile, PlacesTheCentreOfTheUpperLeftPixel) {
    EXPECT_EQ(world_file({{-101, 0, 10, 8}, 0.05}), "0.05\n0\n0\n-0.05\n-5.025\n0.375\n");
}

} // namespace
} // namespace scanloom::tiles
