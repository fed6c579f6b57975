#include "robot_client/app/foxglove_options.hpp"
#include "robot_client/app/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

auto parse_foxglove(std::vector<std::string> words) {
    words.insert(words.begin(), {"scanloom-robot", "--session", "s", "--robot", "r"});
    std::vector<const char*> argv;
    for (const auto& word : words) argv.push_back(word.c_str());
    return parse_options(static_cast<int>(argv.size()), argv.data());
}

TEST(FoxgloveOptions, NameTheBridgeAndWhatIsPublished) {
    const auto result = parse_foxglove({"--spool", "/tmp/s", "foxglove", "ws://robot.lan", "--topic", "/front",
                                        "--mount", "/front=0.2,0,0", "--reopen-for", "5", "--publish-tf",
                                        "--publish-map", "--http", "https://maps.lab:443", "--map-frame", "hall"});
    ASSERT_TRUE(std::holds_alternative<RobotOptions>(result)) << std::get<Leave>(result).text;
    const auto& options = std::get<RobotOptions>(result);
    EXPECT_EQ(options.spool, "/tmp/s");
    const auto& foxglove = std::get<FoxgloveOptions>(options.source);
    EXPECT_EQ(foxglove.bridge->address.text(), "robot.lan:8765");
    EXPECT_EQ(foxglove.robot.topics, std::vector<std::string>{"/front"});
    EXPECT_EQ(foxglove.robot.mounts.at(0).T_robot_laser.x, 0.2);
    EXPECT_EQ(foxglove.reopen_for, 5.0);
    EXPECT_TRUE(foxglove.publish_tf);
    EXPECT_TRUE(foxglove.publish_map);
    EXPECT_EQ(foxglove.map_frame, "hall");
    EXPECT_EQ(foxglove.http->address.text(), "maps.lab:443");
}

TEST(FoxgloveOptions, NothingIsPublishedByDefault) {
    const auto result = parse_foxglove({"foxglove", "ws://robot.lan"});
    const auto& foxglove = std::get<FoxgloveOptions>(std::get<RobotOptions>(result).source);
    EXPECT_FALSE(foxglove.publish_tf);
    EXPECT_FALSE(foxglove.publish_map);
    EXPECT_FALSE(std::get<RobotOptions>(result).poses) << "the robot decides";
}

TEST(FoxgloveOptions, MistakesAreUsageErrors) {
    const std::pair<std::vector<std::string>, const char*> cases[] = {
        {{"foxglove"}, "foxglove: name the URL of the bridge"},
        {{"foxglove", "robot.lan:8765"}, "'robot.lan:8765' is not ws://HOST:PORT or wss://HOST:PORT"},
        {{"foxglove", "ws://r", "--publish-map"}, "--publish-map needs the server's HTTP API; give it with --http"},
        {{"foxglove", "ws://r", "--http", "http://h"}, "--http is only for --publish-map"},
        {{"foxglove", "ws://r", "--publish-map", "--http", "ws://h"}, "'ws://h' is not http://HOST:PORT"},
        {{"foxglove", "ws://r", "--map-frame", ""}, "--map-frame: it is given but empty"},
        {{"foxglove", "ws://r", "--reopen-for", "-1"}, "--reopen-for"},
        {{"foxglove", "ws://r", "--mount", "1,2"}, "--mount"},
    };
    for (const auto& [words, mistake] : cases) {
        const auto result = parse_foxglove(words);
        ASSERT_TRUE(std::holds_alternative<Leave>(result)) << mistake;
        EXPECT_EQ(std::get<Leave>(result).code, kExitUsage);
        EXPECT_THAT(std::get<Leave>(result).text, HasSubstr(mistake));
    }
}

} // namespace
} // namespace scanloom::robot
