#include "robot_client/app/truth.hpp"

#include "sim/ground_truth.hpp"
#include "sim/robot/world_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace scanloom::robot {
namespace {

TEST(GroundTruth, WrittenWorldHasTheSameTruth) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "scanloom truth_test";
    std::filesystem::remove_all(folder);
    const std::string prefix = (folder / "deep" / "the room: 1").string();
    const auto line = write_ground_truth({"room", 0.1, prefix});
    ASSERT_TRUE(line) << line.error().message;
    EXPECT_EQ(*line, R"({"width":104,"height":104,"map":")" + prefix + R"(.yaml"})");
    const auto world = sim::load_world(prefix + ".yaml");
    ASSERT_TRUE(world) << world.error().message;
    EXPECT_EQ(ground_truth_of(*world, 0.1).cells, ground_truth_of(sim::make_room(), 0.1).cells);
    std::filesystem::remove_all(folder);
}

TEST(GroundTruth, WrittenMapHasTheTruthOfEveryNamedWorld) {
    const std::string prefix = std::filesystem::path(testing::TempDir()) / "scanloom_truth_of";
    for (const sim::NamedWorld& world : sim::kWorlds) {
        ASSERT_TRUE(write_ground_truth({std::string(world.name), 0.2, prefix})) << world.name;
        const auto written = sim::load_world(prefix + ".yaml");
        ASSERT_TRUE(written) << written.error().message;
        EXPECT_EQ(ground_truth_of(*written, 0.2).cells, ground_truth_of(world.make(), 0.2).cells) << world.name;
    }
    for (const char* end : {".pgm", ".yaml"}) std::filesystem::remove(prefix + end);
}

TEST(GroundTruth, WriteFailureIsReported) {
    EXPECT_THAT(write_ground_truth({"room", 0.1, "/proc/none/room"}).error().message,
                testing::HasSubstr("/proc/none: the folder cannot be created"));
    EXPECT_THAT(write_ground_truth({"room", 0.1, "/proc/room"}).error().message,
                testing::HasSubstr("/proc/room.pgm: the file cannot be written"));
    EXPECT_THAT(write_ground_truth({"moon", 0.1, "/nonexistent/moon"}).error().message, testing::HasSubstr("moon"));
    EXPECT_EQ(write_ground_truth({"hall", 0.001, "/nonexistent/hall"}).error().code, Errc::kTooLarge);
}

} // namespace
} // namespace scanloom::robot
