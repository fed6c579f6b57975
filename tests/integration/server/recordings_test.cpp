#include "tests/integration/server/programs_fixture.hpp"

namespace scanloom::test {
namespace {

const auto kRecordings = kRealData / "recordings";

class Recordings : public ProgramsTest {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kRecordings))
            GTEST_SKIP() << "the recordings, which are no part of the project, are missing: " << kRecordings;
    }

    [[nodiscard]] boost::json::value robot_of(const std::string& session) const {
        return server_.get_json("/api/v1/sessions/" + session).at("robots").at(0);
    }
};

/// A drive of a TurtleBot3 around nine pillars: a bag of ROS 1 without transforms, and the same messages as ROS 2 with
/// transforms.
TEST_F(Recordings, OfOneDriveGiveTheSameMaps) {
    for (const auto* name : {"fuse_turtlebot3.bag", "turtlebot3_ros2_zstd.mcap"}) {
        stream(name[0] == 'f' ? "bag" : "mcap", "0.05",
               {"--poses", "odometry", "replay", (kRecordings / name).string(), "--mount", "-0.064,0,0"});
    }
    EXPECT_EQ(layers("bag"), layers("mcap"));
    EXPECT_EQ(robot_of("bag").at("scans"), 457);
    EXPECT_EQ(robot_of("bag").at("localization").at("state"), "tracking");
}

/// Two thirds of the beams of a standing laser have no return, and people walk around it.
TEST_F(Recordings, OfAStandingLaserGiveAMap) {
    stream("people", "0.05", {"replay", (kRecordings / "leg_tracker_positive_7.bag").string()});
    EXPECT_EQ(robot_of("people").at("scans"), 510);
}

} // namespace
} // namespace scanloom::test
