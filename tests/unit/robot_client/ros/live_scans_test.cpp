#include "robot_client/ros/live_scans.hpp"
#include "tests/support/ros_bytes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing_support::flat;

constexpr RosTime kLiveBegin = 1'600'000'000'000'000'000;
constexpr RosTime kStep = 100'000'000;

const RecordedTopic kScan{"/scan", "sensor_msgs/LaserScan", MessageEncoding::kRos1};
const RecordedTopic kRear{"/rear", "sensor_msgs/LaserScan", MessageEncoding::kRos1};
const RecordedTopic kTf{"/tf", "tf2_msgs/TFMessage", MessageEncoding::kRos1};
const RecordedTopic kTfStatic{"/tf_static", "tf2_msgs/TFMessage", MessageEncoding::kRos1};
const RecordedTopic kOdom{"/odom", "nav_msgs/Odometry", MessageEncoding::kRos1};

class LiveScansTest : public testing::Test {
protected:
    void begin(const RecordingOptions& options = {}) { scans_.emplace(LiveScanOptions{options, 2s, 5s, 1s}); }

    /// Adds the pose x = 0.1 m times the count at a tenth of a second.
    void add_pose(int tenth, const std::string& parent = "odom") {
        const auto bytes = testing_support::transform_bytes({flat(stamp(tenth), parent, "base", 0.1 * tenth)});
        static_cast<void>(scans_->add(kTf, stamp(tenth), bytes, now_));
    }

    void add_mount(const std::string& laser = "laser", double x = 0.25) {
        const auto bytes = testing_support::transform_bytes({flat(0, "base", laser, x)});
        static_cast<void>(scans_->add(kTfStatic, stamp(0), bytes, now_));
    }

    void add_odometry(int tenth) {
        const auto bytes = testing_support::odometry_bytes(flat(stamp(tenth), "odom", "base", 0.1 * tenth));
        static_cast<void>(scans_->add(kOdom, stamp(tenth), bytes, now_));
    }

    /// Adds a scan of half a tenth of a second later.
    void add_scan(int tenth, const RecordedTopic& topic = kScan, const std::string& frame = "laser",
                  float range = 1.0F) {
        const RosLaserScan scan{{stamp(tenth) + kStep / 2, frame}, -1.0F, 1.0F, 0.5F, 0.0F, 0.1F, 0.1F, 10.0F,
                                std::vector<float>(5, range)};
        const auto found = scans_->add(topic, stamp(tenth), testing_support::laser_bytes(scan), now_);
        EXPECT_EQ(found, stamp(tenth) + kStep / 2);
    }

    void choose() {
        const auto chosen = scans_->choose(LiveScans::Time::max());
        ASSERT_TRUE(chosen) << chosen.error().message;
        ASSERT_TRUE(*chosen);
    }

    /// Surveys a robot with a pose, a mount and one scan, which is taken.
    void survey() {
        begin();
        add_mount();
        add_pose(0);
        add_scan(0);
        add_pose(1);
        choose();
        ASSERT_TRUE(scans_->take(now_));
    }

    /// Returns the x of the poses of all scans that can be taken.
    std::vector<double> taken() {
        std::vector<double> xs;
        while (const auto one = scans_->take(now_)) xs.push_back(one->scan.odometry.value_or(Pose2{}).x);
        return xs;
    }

    static RosTime stamp(int tenth) { return kLiveBegin + tenth * kStep; }

    std::optional<LiveScans> scans_;
    LiveScans::Time now_{};
};

TEST_F(LiveScansTest, TheSurveyEndsSomeTimeAfterTheFirstScan) {
    begin();
    add_pose(0);
    EXPECT_EQ(scans_->survey_end(), std::nullopt);
    now_ += 7s;
    add_scan(0);
    EXPECT_EQ(scans_->survey_end(), now_ + 2s);
    now_ += 1s;
    add_scan(1);
    EXPECT_EQ(scans_->survey_end(), now_ + 1s);
    EXPECT_FALSE(scans_->take(now_)) << "nothing is taken before the choice";
}

TEST_F(LiveScansTest, TheSurveyWaitsForTheTopicsThatOptionsName) {
    begin({.topics = {"/scan", "/rear"}, .mounts = {{"/front", {}}}});
    add_scan(0);
    EXPECT_EQ(scans_->survey_end(), std::nullopt);
    EXPECT_THAT(scans_->missing_topics(), ElementsAre("/front", "/rear"));
    EXPECT_FALSE(scans_->needs({"/other", "sensor_msgs/LaserScan", MessageEncoding::kCdr}));
}

TEST_F(LiveScansTest, TheSurveyGoesOnWhileOdometryAMountOrAFrameIsMissing) {
    const auto is_chosen = [&] {
        const auto chosen = scans_->choose(now_);
        EXPECT_TRUE(chosen) << chosen.error().message;
        return chosen && *chosen;
    };
    for (const std::string frame : {"", "base"}) {
        begin({.base_frame = frame});
        const auto end_max = now_ + 5s;
        add_scan(0);
        now_ += 2s;
        EXPECT_FALSE(is_chosen()) << "no odometry";
        EXPECT_EQ(scans_->survey_end(), now_ + 500ms);
        add_pose(0);
        EXPECT_FALSE(is_chosen()) << "no mount";
        now_ = end_max - 100ms;
        EXPECT_FALSE(is_chosen());
        EXPECT_EQ(scans_->survey_end(), end_max);
        add_mount();
        EXPECT_TRUE(is_chosen());
        EXPECT_EQ(scans_->choice().frames.poses, Poses::kOdometry);
    }
    begin();
    add_scan(0);
    now_ += 5s;
    EXPECT_TRUE(is_chosen());
    EXPECT_EQ(scans_->choice().frames.poses, Poses::kNone);
    begin();
    scans_->expect_poses(Poses::kNone);
    add_scan(0);
    EXPECT_TRUE(is_chosen()) << "nothing more is needed";
}

TEST_F(LiveScansTest, ScansOfTheSurveyAreTakenWithPosesAndMountsOfTheTransforms) {
    begin();
    add_mount();
    for (int n = 0; n < 3; ++n) {
        add_pose(n);
        add_scan(n);
    }
    choose();
    EXPECT_EQ(scans_->choice().frames.poses, Poses::kOdometry);
    EXPECT_EQ(scans_->choice().frames.base, "base");
    EXPECT_EQ(scans_->choice().frames.fixed, "odom");
    const auto first = scans_->take(now_);
    ASSERT_TRUE(first);
    EXPECT_NEAR(first->scan.odometry->x, 0.05, 1e-9);
    EXPECT_EQ(first->sensor->mount.x, 0.25);
    EXPECT_EQ(first->sensor->name, "/scan");
    EXPECT_EQ(first->scan.stamp, static_cast<double>(stamp(0) + kStep / 2) / 1e9);
    EXPECT_EQ(taken().size(), 1U) << "the last one waits for its transform";
    add_pose(3);
    EXPECT_THAT(taken(), ElementsAre(testing::DoubleNear(0.25, 1e-9)));
    EXPECT_EQ(scans_->take(now_), std::nullopt);
    EXPECT_THAT(scans_->skipped(), IsEmpty());
}

TEST_F(LiveScansTest, AScanThatGetsNoTransformIsSkippedWhenItsWaitEnds) {
    survey();
    add_scan(1);
    EXPECT_THAT(taken(), IsEmpty());
    EXPECT_EQ(scans_->next_deadline(), now_ + 1s);
    now_ += 999ms;
    EXPECT_THAT(taken(), IsEmpty());
    EXPECT_THAT(scans_->skipped(), IsEmpty());
    now_ += 1ms;
    EXPECT_THAT(taken(), IsEmpty());
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("after the last pose", 1)));
    EXPECT_EQ(scans_->next_deadline(), std::nullopt);
}

TEST_F(LiveScansTest, WhileMessagesAreInterruptedScansWaitOn) {
    survey();
    add_scan(1);
    scans_->interrupt();
    now_ += 60s;
    EXPECT_THAT(taken(), IsEmpty());
    EXPECT_EQ(scans_->next_deadline(), std::nullopt);
    scans_->resume(now_);
    EXPECT_EQ(scans_->next_deadline(), now_ + 1s);
    add_pose(2);
    EXPECT_EQ(taken().size(), 1U);
    EXPECT_THAT(scans_->skipped(), IsEmpty());
}

TEST_F(LiveScansTest, AtTheEndNoScanWaits) {
    survey();
    add_scan(1);
    scans_->interrupt();
    EXPECT_FALSE(scans_->take(LiveScans::Time::max()));
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("after the last pose", 1)));
}

TEST_F(LiveScansTest, AScanFromBeforeTheFirstPoseDoesNotWait) {
    begin();
    add_mount();
    add_scan(0);
    add_pose(1);
    add_scan(1);
    add_pose(2);
    choose();
    EXPECT_EQ(taken().size(), 1U);
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("before the first pose", 1)));
}

TEST_F(LiveScansTest, WithoutTransformsPosesComeFromOdometry) {
    begin();
    add_odometry(0);
    add_scan(0);
    add_odometry(1);
    choose();
    EXPECT_EQ(scans_->odom_topic(), "/odom");
    EXPECT_THAT(scans_->take_notes(), ElementsAre(HasSubstr("/scan: its mount on the robot is not known")));
    EXPECT_TRUE(scans_->needs(kOdom));
    EXPECT_FALSE(scans_->needs({"/odom2", "nav_msgs/Odometry", MessageEncoding::kRos1}));
    add_scan(1);
    add_odometry(2);
    EXPECT_THAT(taken(), ElementsAre(testing::DoubleNear(0.05, 1e-9), testing::DoubleNear(0.15, 1e-9)));
}

TEST_F(LiveScansTest, OdometryThatNamesNoFrameOfTheRobotIsUsed) {
    for (const std::string frame : {"odom", "base", ""}) {
        begin();
        for (const int tenth : {0, 1}) {
            const auto pose = flat(stamp(tenth), frame, frame, tenth);
            static_cast<void>(scans_->add(kOdom, stamp(tenth), testing_support::odometry_bytes(pose), now_));
        }
        add_scan(0);
        choose();
        EXPECT_THAT(taken(), ElementsAre(testing::DoubleNear(0.5, 1e-9))) << frame;
    }
}

TEST_F(LiveScansTest, ChosenOdometryReplacesTheTransformsOfItsRobot) {
    begin({.odom_topic = "/odom"});
    add_mount();
    add_pose(0);
    add_odometry(0);
    add_scan(0);
    choose();
    const auto elsewhere = testing_support::transform_bytes({flat(stamp(1), "odom", "base", 99.0)});
    static_cast<void>(scans_->add(kTf, stamp(1), elsewhere, now_));
    EXPECT_THAT(taken(), IsEmpty());
    add_odometry(1);
    EXPECT_THAT(taken(), ElementsAre(testing::DoubleNear(0.05, 1e-9)));
}

TEST_F(LiveScansTest, WithoutPosesScansHaveNone) {
    begin();
    add_scan(0);
    choose();
    EXPECT_EQ(scans_->choice().frames.poses, Poses::kNone);
    const auto scan = scans_->take(now_);
    ASSERT_TRUE(scan);
    EXPECT_FALSE(scan->scan.odometry);
    EXPECT_FALSE(scan->scan.pose);
}

TEST_F(LiveScansTest, AMapFrameGivesPosesInTheMap) {
    begin();
    add_mount();
    add_pose(0, "map");
    add_scan(0);
    add_pose(1, "map");
    choose();
    EXPECT_EQ(scans_->choice().frames.poses, Poses::kMap);
    EXPECT_NEAR(scans_->take(now_)->scan.pose->x, 0.05, 1e-9);
}

TEST_F(LiveScansTest, LasersWithoutAMountAreLeftOutAndNotNeeded) {
    begin();
    add_mount();
    add_pose(0);
    add_scan(0);
    add_scan(0, kRear, "rear");
    add_pose(1);
    choose();
    EXPECT_THAT(scans_->take_notes(), ElementsAre(HasSubstr("/rear: its 1 scans are left out")));
    EXPECT_TRUE(scans_->needs(kScan));
    EXPECT_FALSE(scans_->needs(kRear));
    EXPECT_EQ(taken().size(), 1U);
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("mount unknown", 1)));
}

TEST_F(LiveScansTest, ALaserWithAMountIsUsedInsteadOfOneWithMoreScans) {
    begin();
    add_mount();
    for (const int n : {0, 1}) add_scan(n, kScan, "elsewhere");
    add_scan(1, kRear);
    choose();
    EXPECT_EQ(scans_->choice().frames.base, "base");
    const auto taken = scans_->take(now_);
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->sensor->name, "/rear");
}

TEST_F(LiveScansTest, ALaserThatAppearsAfterTheChoiceIsLate) {
    survey();
    EXPECT_TRUE(scans_->is_late_laser(kRear));
    EXPECT_FALSE(scans_->is_late_laser(kScan));
    EXPECT_FALSE(scans_->is_late_laser(kOdom));
    EXPECT_FALSE(scans_->needs(kRear));
}

TEST_F(LiveScansTest, ErrorsOfTheChoiceNameTheBridge) {
    begin({.base_frame = "nothing"});
    add_pose(0);
    add_scan(0);
    EXPECT_THAT(scans_->choose(LiveScans::Time::max()).error().message,
                HasSubstr("--base-frame nothing: no transform has this frame"));
    begin({.odom_topic = "/wheels"});
    add_scan(0);
    EXPECT_THAT(scans_->choose(LiveScans::Time::max()).error().message,
                HasSubstr("the bridge has no readable nav_msgs/Odometry"));
}

TEST_F(LiveScansTest, MalformedAndUnusableScansAreCounted) {
    survey();
    static_cast<void>(scans_->add(kScan, stamp(1), "nonsense", now_));
    static_cast<void>(scans_->add(kTf, stamp(1), "nonsense", now_));
    RosLaserScan none{{stamp(1), "laser"}, 0.0F, 0.0F, 0.1F, 0.0F, 0.0F, 0.0F, 1.0F, {}};
    static_cast<void>(scans_->add(kScan, stamp(1), testing_support::laser_bytes(none), now_));
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("malformed messages", 1), Pair("no beams", 1)));
}

TEST_F(LiveScansTest, TheNumberOfWaitingScansIsBounded) {
    survey();
    for (std::size_t n = 0; n <= LiveScans::kWaitingMax; ++n) add_scan(static_cast<int>(n) + 1);
    EXPECT_THAT(scans_->skipped(), ElementsAre(Pair("too many were waiting", 1)));
}

TEST_F(LiveScansTest, ReadingsAboveTheRangeAreNoReturnsUntilOneIsInfinite) {
    begin();
    add_scan(0, kScan, "laser", 81.9F);
    choose();
    EXPECT_EQ(scans_->take(now_)->scan.ranges.front(), kNoReturn);
    add_scan(1, kScan, "laser", std::numeric_limits<float>::infinity());
    add_scan(2, kScan, "laser", 81.9F);
    EXPECT_EQ(scans_->take(now_)->scan.ranges.front(), kNoReturn) << "the infinite one";
    EXPECT_EQ(scans_->take(now_)->scan.ranges.front(), kInvalidRange);
}

TEST_F(LiveScansTest, MissingScansAreEstimatedAndNotedOnce) {
    survey();
    for (int n = 1; n < 20; ++n) add_scan(n);
    EXPECT_THAT(scans_->take_notes(), IsEmpty());
    add_scan(23);
    add_scan(25);
    EXPECT_EQ(scans_->missing(), 4U);
    EXPECT_EQ(scans_->gaps(), 2U);
    EXPECT_THAT(scans_->take_notes(), ElementsAre(HasSubstr("/scan: about 3 scans are missing between two stamps")));
    scans_->interrupt();
    scans_->resume(now_);
    add_scan(90);
    EXPECT_EQ(scans_->missing(), 4U) << "what was sent while there was no connection";
}

} // namespace
} // namespace scanloom::robot
