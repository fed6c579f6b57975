#include "sim/robot/world_file.hpp"

#include "sim/drive/wall_follower.hpp"
#include "sim/ground_truth.hpp"
#include "sim/ray_casting.hpp"
#include "sim/simulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace scanloom::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WorldFile : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_ / "images"); }
    void TearDown() override { fs::remove_all(folder_); }

    std::string write(const std::string& name, std::string_view content) const {
        std::ofstream(folder_ / name, std::ios::binary) << content;
        return (folder_ / name).string();
    }

    /// Returns a free square of 9 x 9 m with a resolution of 0.5 m.
    static std::string square(int side = 18) {
        std::string pgm = "P5 " + std::to_string(side) + " " + std::to_string(side) + " 255\n";
        return pgm + std::string(static_cast<std::size_t>(side * side), '\xFE');
    }

    const fs::path folder_ =
        fs::path(testing::TempDir()) /
        (std::string("scanloom_world_file_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(WorldFile, ImagePathIsRelativeToTheDescription) {
    write("images/a map.pgm", square());
    const auto yaml = write("m.yaml", "image: images/a map.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
    const auto world = load_world(yaml);
    ASSERT_TRUE(world) << world.error().message;
    EXPECT_EQ(world->name, "m");
    EXPECT_THAT(world->floors, testing::ElementsAre(Box{0, 0, 9, 9}));
    const auto absolute =
        write("n.yml", "image: " + (folder_ / "images/a map.pgm").string() + "\nresolution: 0.5\norigin: [0, 0, 0]\n");
    EXPECT_TRUE(load_world(absolute));
}

TEST_F(WorldFile, OtherNamesAreBuiltInWorlds) {
    EXPECT_EQ(load_world("office")->name, "office");
    EXPECT_THAT(load_world("moon").error().message, HasSubstr("unknown world 'moon'"));
    EXPECT_TRUE(is_world_file("a/b.yaml") && is_world_file("b.yml"));
    EXPECT_FALSE(is_world_file("office") || is_world_file("b.pgm"));
}

TEST_F(WorldFile, UnreadableFileIsRefusedByName) {
    const auto why = [&](const std::string& yaml) {
        const auto world = load_world(write("m.yaml", yaml));
        return world ? "" : world.error().message;
    };
    const std::string rest = "resolution: 0.5\norigin: [0, 0, 0]\n";
    write("png.pgm", "\x89PNG\r\n\x1A\n");
    EXPECT_THAT(why(rest), HasSubstr("m.yaml: the map's yaml: image is missing"));
    EXPECT_THAT(why("image: none.pgm\n" + rest), HasSubstr("none.pgm: no such file"));
    EXPECT_THAT(why("image: images\n" + rest), HasSubstr("images: no such file"));
    EXPECT_THAT(why("image: png.pgm\n" + rest), HasSubstr("png.pgm: the map's image is not a PGM (P2 or P5)"));
    EXPECT_THAT(why("image: png.pgm\nresolution: 0.5\norigin: [0, 0, 1.5]\n"), HasSubstr("origin is turned"));
    EXPECT_THAT(why("[1, 2"), HasSubstr("m.yaml: the map's yaml cannot be read"));
    write("wall.pgm", "P2 1 1 255 0");
    EXPECT_THAT(why("image: wall.pgm\n" + rest), HasSubstr("wall.pgm: the map has no free place"));
    EXPECT_THAT(load_world((folder_ / "none.yaml").string()).error().message, HasSubstr("none.yaml: no such file"));
}

class RealMap : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Maps, RealMap, testing::Values("depot/depot", "turtlebot3_world/map"),
                         [](const auto& tried) { return std::string(tried.index == 0 ? "depot" : "turtlebot3"); });

TEST_P(RealMap, RobotDrivesThroughIt) {
    const auto yaml = fs::path(SCANLOOM_SOURCE_DIR) / "../shared/data/maps" / (std::string(GetParam()) + ".yaml");
    if (!fs::exists(yaml)) {
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << yaml;
    }
    const auto world = load_world(yaml.string());
    ASSERT_TRUE(world) << world.error().message;
    Random random(2);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Simulator simulator({*world, find_laser("lidar360").value(), std::nullopt, seed},
                            std::make_unique<WallFollower>());
        const Pose2 start = simulator.pose();
        EXPECT_GE(clearance(*world, {start.x, start.y}), kStartClearance - 1e-6);
        const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
        EXPECT_EQ(world->obstacles->cast_ray({start.x, start.y}, yaw, HUGE_VAL),
                  cast_ray(world->outlines, {start.x, start.y}, yaw));
        for (int scan = 0; scan < 300; ++scan) static_cast<void>(simulator.next_scan());
        EXPECT_EQ(simulator.collisions(), 0U) << seed;
        EXPECT_EQ(ground_truth_of(*world, 0.05)
                      .at(static_cast<std::int32_t>(std::floor(simulator.pose().x * 20)),
                          static_cast<std::int32_t>(std::floor(simulator.pose().y * 20))),
                  GroundTruth::kFree);
    }
}

} // namespace
} // namespace scanloom::sim
