#include "common/ros_map/description.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <utility>

namespace scanloom {
namespace {

using testing::HasSubstr;

TEST(RosMapDescription, RefusesInvalidDescriptionsByKey) {
    const std::string good = "image: map.pgm\nresolution: 0.05\norigin: [1, -2.5, 0]\n";
    EXPECT_EQ(parse_ros_yaml(good).value(),
              (RosMapDescription{.image = "map.pgm", .resolution = 0.05, .origin_x = 1.0, .origin_y = -2.5}));
    EXPECT_TRUE(parse_ros_yaml("resolution: 1\norigin: [0, 0]\nnegate: 1\nmode: scale\n"));
    for (const auto* yes : {"true", "yes", "On", "1"}) {
        EXPECT_TRUE(parse_ros_yaml(good + "negate: " + yes + "\n").value().negate) << yes;
    }
    for (const auto* no : {"false", "no", "NO", "off", "0"}) {
        EXPECT_FALSE(parse_ros_yaml(good + "negate: " + no + "\n").value().negate) << no;
    }
    for (const auto& [yaml, why] : std::initializer_list<std::pair<std::string, std::string>>{
             {"", "not a list of keys"},
             {"[1, 2", "cannot be read"},
             {"origin: [0, 0, 0]\n", "resolution is missing"},
             {"resolution: -1\norigin: [0, 0, 0]\n", "resolution is -1"},
             {"resolution: .nan\norigin: [0, 0, 0]\n", "resolution is not a number"},
             {"resolution: 0.05\n", "origin"},
             {"resolution: 0.05\norigin: 3\n", "origin"},
             {"resolution: 0.05\norigin: [0, x, 0]\n", "origin is not a number"},
             {"resolution: 0.05\norigin: [1e30, 0, 0]\n", "origin is too far"},
             {"resolution: 0.05\norigin: [0, 0, 0.1]\n", "origin is turned"},
             {good + "negate: 2\n", "negate"},
             {good + "resolution: 0.1\n", "resolution is given twice"},
             {good + "foo: [" + std::string(70'000, ',') + "]\n", "more than 65536"},
             {good + "mode: rough\n", "mode"},
             {good + "mode: raw\nnegate: 1\n", "negate"},
             {"image: [a]\nresolution: 0.05\norigin: [0, 0, 0]\n", "image"},
             {good + "free_thresh: 0.7\n", "free_thresh"},
             {good + "occupied_thresh: [1]\n", "occupied_thresh is not a number"}}) {
        const auto refused = parse_ros_yaml(yaml);
        ASSERT_FALSE(refused) << yaml;
        EXPECT_THAT(refused.error().message, HasSubstr(why));
    }
}

TEST(RosMapDescription, ParsingReturnsTheWrittenDescription) {
    for (const char* image : {"map.pgm", "a map.pgm", "it's \"mine\": #1 \\ -.pgm", "-", ""}) {
        const auto read = parse_ros_yaml(ros_yaml(image, 0.025, -12.35, 1e-3));
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(*read,
                  (RosMapDescription{.image = image, .resolution = 0.025, .origin_x = -12.35, .origin_y = 1e-3}));
    }
}

TEST(RosMapDescription, GreysAreProbabilities) {
    using enum MapCell;
    const auto at = [](const RosMapDescription& map, std::uint16_t white, std::size_t grey) {
        return cells_of_greys(map, white).at(grey);
    };
    const RosMapDescription plain;
    EXPECT_EQ(cells_of_greys(plain, 255).size(), 256U);
    EXPECT_EQ(at(plain, 255, 89), kOccupied); // p = 166 / 255 = 0.651
    EXPECT_EQ(at(plain, 255, 90), kUnknown);
    EXPECT_EQ(at(plain, 255, 206), kFree); // p = 49 / 255 = 0.192
    EXPECT_EQ(at(plain, 1, 0), kOccupied);
    EXPECT_EQ(at(plain, 1, 1), kFree);
    EXPECT_EQ(at(plain, 65535, 22937), kOccupied); // p = 42598 / 65535 = 0.65000
    EXPECT_EQ(at(plain, 65535, 22938), kUnknown);
    EXPECT_EQ(at({.free_thresh = 0.25}, 65535, 205 * 257), kUnknown) << "map_saver's grey for unknown, at any depth";
    EXPECT_EQ(at({.mode = RosMapMode::kScale, .free_thresh = 0.25}, 65535, 205 * 257), kFree);
}

TEST(RosMapDescription, RawGreysArePercentages) {
    using enum MapCell;
    const auto cells = cells_of_greys({.mode = RosMapMode::kRaw}, 255);
    EXPECT_EQ(cells[0], kFree);
    EXPECT_EQ(cells[19], kFree);
    EXPECT_EQ(cells[20], kUnknown);
    EXPECT_EQ(cells[65], kUnknown);
    EXPECT_EQ(cells[66], kOccupied);
    EXPECT_EQ(cells[100], kOccupied);
    for (std::size_t grey = 101; grey < 256; ++grey) EXPECT_EQ(cells[grey], kUnknown) << grey;
    EXPECT_EQ(cells_of_greys({.mode = RosMapMode::kRaw}, 65535)[100 * 257], kOccupied);
}

} // namespace
} // namespace scanloom
