#include "robot_client/ros/recorded_scans.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/ros_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::flat;

/// A bag with frames of any robots. Times are tenths of a second since 2020.
class RecordedFramesTest : public testing::Test {
protected:
    void scan(const std::string& topic, RosTime time, const std::string& frame = "laser") {
        const RosLaserScan scan{{nanoseconds(time), frame}, -1, 1, 0.5F, 0, 0.1F, 0.1F, 10, {1, 1, 1, 1, 1}};
        write(topic, "sensor_msgs/LaserScan", testing_support::laser_bytes(scan));
    }
    void odometry(const std::string& topic, RosTime time, double x, const std::string& child = "base") {
        const auto pose = flat(nanoseconds(time), "odom", child, x);
        write(topic, "nav_msgs/Odometry", testing_support::odometry_bytes(pose, MessageEncoding::kRos1));
    }
    void transform(const std::string& topic, RosTime time, const std::string& parent, const std::string& child,
                   double x) {
        const auto pose = flat(nanoseconds(time), parent, child, x);
        write(topic, "tf2_msgs/TFMessage", testing_support::transform_bytes({pose}, MessageEncoding::kRos1));
    }

    /// Begins another bag.
    void start() {
        writer_ = testing_support::BagWriter();
        connections_.clear();
        written_ = 0;
    }

    /// Reads what was written.
    std::vector<Observation> read(const RecordingOptions& options = {}) {
        auto scans = open(options);
        EXPECT_TRUE(scans) << scans.error().message;
        std::vector<Observation> all;
        if (!scans) return all;
        plan_ = scans->plan();
        while (auto one = scans->next().value()) all.push_back(std::move(*one));
        return all;
    }

    std::string refused(const RecordingOptions& options = {}) {
        const auto scans = open(options);
        return scans ? "" : scans.error().message;
    }

    RecordingPlan plan_;

private:
    static RosTime nanoseconds(RosTime tenths) { return 1'600'000'000'000'000'000 + tenths * 100'000'000; }

    void write(const std::string& topic, const std::string& type, const std::string& bytes) {
        auto connection = connections_.find(topic);
        if (connection == connections_.end()) {
            connection = connections_.emplace(topic, writer_.connect(topic, type)).first;
        }
        writer_.write(connection->second, nanoseconds(0) + written_++, bytes);
    }

    Result<RecordedScans> open(const RecordingOptions& options) {
        const auto path = directory_.path() / "recording.bag";
        auto writer = writer_;
        std::ofstream(path, std::ios::binary) << writer.finish().file;
        return RecordedScans::open(path, options);
    }

    TemporaryDirectory directory_;
    testing_support::BagWriter writer_;
    std::map<std::string, std::uint32_t> connections_;
    RosTime written_ = 0; // messages
};

/// As of a simulation that began again, or of a clock that was set back.
TEST_F(RecordedFramesTest, StampsThatComeTwiceHaveThePosesOfTheirTime) {
    transform("/tf_static", 0, "base", "laser", 0.0);
    for (const double x : {0.0, 50.0}) {
        for (RosTime time = 0; time <= 60; ++time) {
            transform("/tf", time, "odom", "base", x + static_cast<double>(time));
            if (time % 10 == 0) scan("/scan", time);
        }
    }
    const auto all = read();
    ASSERT_EQ(all.size(), 14U);
    for (std::size_t n = 0; n < all.size(); ++n) {
        const double x = n < 7 ? 10.0 * static_cast<double>(n) : 50.0 + 10.0 * static_cast<double>(n - 7);
        EXPECT_NEAR(all[n].scan.odometry.value().x, x, 1e-6) << n;
    }
    EXPECT_TRUE(plan_.stamps.is_clock_set_back);
}

/// Parts of a recording that are joined in the wrong order complete each other.
TEST_F(RecordedFramesTest, PartsOutOfOrderShareTheirTransforms) {
    for (const auto& [begin, end] : {std::pair(51, 99), std::pair(0, 49)}) {
        for (RosTime time = begin; time <= end; ++time) {
            transform("/tf", time, "odom", "laser", static_cast<double>(time));
            if (time % 10 == 5) scan("/scan", time);
        }
    }
    scan("/scan", 50);
    const auto all = read();
    ASSERT_EQ(all.size(), 11U);
    EXPECT_NEAR(all[5].scan.odometry.value().x, 50.0, 1e-6) << "between a transform of each part";
}

/// Stamps that are wrong, late or of another rate cost no other scan, in whatever order the streams notice a step.
TEST_F(RecordedFramesTest, DisturbedStampsCostNoOtherScans) {
    for (const RosTime wrong : {-300, -50, 30, 50, 80, 2'000}) {
        for (const RosTime transforms_begin : {0, 100}) {
            SCOPED_TRACE(testing::Message() << wrong << " " << transforms_begin);
            start();
            for (RosTime time = 0; time <= 300; ++time) {
                if (time >= transforms_begin) transform("/tf", time, "odom", "base", static_cast<double>(time));
                if (time % 50 == 0) transform("/tf", time, "base", "laser", 0.25);
                if (time % 5 == 2) scan("/scan", time == 52 ? time + wrong : time);
            }
            std::size_t others = 0;
            for (const auto& one : read()) {
                const double x = (one.scan.stamp - 1.6e9) * 10.0;
                EXPECT_NEAR(one.scan.odometry.value().x, x, 1e-3);
                if (std::fabs(x - static_cast<double>(52 + wrong)) > 0.5) ++others;
            }
            EXPECT_GE(others, transforms_begin == 0 ? 58U : 39U); // another one may have the time of the wrong stamp
        }
    }
}

TEST_F(RecordedFramesTest, ScansThatArriveLateHaveTheirPoses) {
    for (RosTime time = 0; time <= 300; ++time) {
        transform("/tf", time, "odom", "laser", static_cast<double>(time));
        if (time % 5 == 0 && (time < 100 || time >= 140)) scan("/scan", time);
        for (RosTime late = 100; time == 145 && late < 140; late += 5) scan("/scan", late);
    }
    EXPECT_EQ(read().size(), 61U);
}

/// A clock is set back by 4 s; one transform is sent every 5 s, so that its stamps do not fall.
TEST_F(RecordedFramesTest, RareTransformsHoldAfterAClockWasSetBack) {
    for (const auto& [begin, end] : {std::pair(0, 190), std::pair(150, 300)}) {
        for (RosTime time = begin; time <= end; ++time) {
            if (time % 50 == 0) transform("/tf", time, "base", "laser", 0.25);
            transform("/tf", time, "odom", "base", static_cast<double>(begin + time));
            if (time % 10 == 5) scan("/scan", time);
        }
    }
    const auto all = read();
    ASSERT_EQ(all.size(), 19U + 15U);
    for (std::size_t n = 0; n < all.size(); ++n) {
        const double time = (all[n].scan.stamp - 1.6e9) * 10.0;
        EXPECT_NEAR(all[n].scan.odometry.value().x, n < 19 ? time : time + 150.0, 1e-3);
    }
}

/// Many robots name a frame in their odometry that no transform has.
TEST_F(RecordedFramesTest, OdometryOfAnUnknownFrameIsThatOfTheStatedOne) {
    transform("/tf_static", 0, "base_link", "laser", 0.25);
    transform("/tf_static", 0, "shelf", "box", 0.0);
    for (RosTime time = 0; time <= 20; ++time) odometry("/odom", time, static_cast<double>(time), "base_footprint");
    scan("/scan", 10);
    const auto all = read({.base_frame = "base_link"});
    ASSERT_EQ(all.size(), 1U);
    EXPECT_NEAR(all[0].scan.odometry.value().x, 10.0, 1e-6);
    EXPECT_EQ(all[0].sensor->mount, (Pose2{0.25, 0.0, 0.0}));
    EXPECT_EQ(plan_.base_frame, "base_link");
}

TEST_F(RecordedFramesTest, OdometryOfAnotherFrameThanTheStatedOneIsRefused) {
    transform("/tf_static", 0, "base", "laser", 0.25);
    transform("/tf_static", 0, "base", "dock", 0.25);
    for (RosTime time = 0; time <= 20; ++time) odometry("/odom", time, static_cast<double>(time), "dock");
    scan("/scan", 10);
    EXPECT_THAT(refused({.base_frame = "base"}),
                HasSubstr("--base-frame base: the poses of /odom are those of the frame "
                          "dock, from which no transforms lead to base"));
    EXPECT_EQ(read({.poses = Poses::kNone, .base_frame = "base"}).size(), 1U);
}

TEST_F(RecordedFramesTest, EachRobotHasTheOdometryOfItsNamespace) {
    for (RosTime time = 0; time <= 20; ++time) {
        odometry("/r2/odom", time, 2.0, "r2/base");
        odometry("/r1/odom", time, 1.0, "r1/base");
        if (time < 5) odometry("/r2/odom", time, 2.0, "r2/base");
    }
    scan("/r1/scan", 10, "r1/laser");
    scan("/r2/scan", 10, "r2/laser");
    EXPECT_NEAR(read({.topics = {"/r1/scan"}}).at(0).scan.odometry.value().x, 1.0, 1e-6);
    EXPECT_NEAR(read({.topics = {"/r2/scan"}}).at(0).scan.odometry.value().x, 2.0, 1e-6);
}

/// The robots of a fleet have frames of the same names in transforms of their namespaces.
TEST_F(RecordedFramesTest, EachRobotHasTheTransformsOfItsNamespace) {
    for (RosTime time = 0; time <= 20; ++time) {
        transform("/r1/tf", time, "odom", "base", 1.0);
        transform("/r2/tf", time, "odom", "base", 2.0);
    }
    transform("/tf_static", 0, "base", "laser", 0.25); // of both
    scan("/r1/scan", 10);
    scan("/r2/scan", 10);
    for (const auto& [topic, x] : {std::pair("/r1/scan", 1.0), std::pair("/r2/scan", 2.0)}) {
        const auto all = read({.topics = {topic}});
        ASSERT_EQ(all.size(), 1U);
        EXPECT_NEAR(all[0].scan.odometry.value().x, x, 1e-6);
        EXPECT_EQ(all[0].sensor->mount.x, 0.25);
    }
}

TEST_F(RecordedFramesTest, TheNearestNamespaceCounts) {
    for (RosTime time = 0; time <= 20; ++time) {
        transform("/tf", time, "odom", "base", 1.0);
        transform("/r2/tf", time, "odom", "base", 2.0);
    }
    transform("/tf_static", 0, "base", "laser", 0.25);
    scan("/r2/scan", 10);
    scan("/r2/scan", 11);
    scan("/r1/scan", 10);
    EXPECT_NEAR(read({.topics = {"/r2/scan"}}).at(0).scan.odometry.value().x, 2.0, 1e-6);
    EXPECT_NEAR(read({.topics = {"/r1/scan"}}).at(0).scan.odometry.value().x, 1.0, 1e-6);
    EXPECT_THAT(refused({.topics = {"/r2/scan", "/r1/scan"}}), HasSubstr("replay each robot by itself"));
}

TEST_F(RecordedFramesTest, LasersOfOtherNamespacesAreLeftOutAndNoted) {
    for (RosTime time = 0; time <= 20; ++time) {
        transform("/r1/tf", time, "odom", "laser", 1.0);
        transform("/r2/tf", time, "odom", "laser", 2.0);
        if (time % 5 == 0) scan("/r1/scan", time);
    }
    scan("/r2/scan", 10);
    EXPECT_EQ(read().size(), 5U);
    EXPECT_THAT(plan_.notes, ElementsAre("/r2/scan: its 1 scans are of another robot; replay them as that robot with "
                                         "--topic /r2/scan"));
    start();
    for (RosTime time = 0; time <= 20; ++time) transform("/r2/tf", time, "odom", "laser", 2.0);
    scan("/r1/scan", 10);
    EXPECT_EQ(read().size(), 1U);
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("the transforms are in other namespaces, /r2")));
    start();
    for (RosTime time = 0; time <= 20; ++time) {
        odometry("/r1/odom", time, 1.0);
        odometry("/r2/odom", time, 2.0);
        if (time % 5 == 0) scan("/r1/scan", time, "l1");
    }
    scan("/r2/scan", 10, "l2");
    EXPECT_EQ(read().size(), 5U);
    EXPECT_THAT(plan_.notes, Contains(HasSubstr("replay them as another robot with --topic /r2/scan")));
}

TEST_F(RecordedFramesTest, ALaserOfAnotherRobotIsNoted) {
    for (RosTime time = 0; time <= 20; ++time) {
        transform("/tf", time, "r1/odom", "r1/base", 1.0);
        transform("/tf", time, "r2/odom", "r2/base", 2.0);
        if (time % 5 == 0) scan("/r1/scan", time, "r1/laser");
    }
    transform("/tf_static", 0, "r1/base", "r1/laser", 0.0);
    transform("/tf_static", 0, "r2/base", "r2/laser", 0.0);
    scan("/r2/scan", 10, "r2/laser");
    EXPECT_EQ(read().size(), 5U);
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("from the frame r2/base, and not from the robot's frame r1/base")));
    EXPECT_THAT(plan_.notes[0], HasSubstr("replay them as that robot with --topic /r2/scan"));
}

TEST_F(RecordedFramesTest, PosesInFramesOfOtherNamesAreNoted) {
    for (RosTime time = 0; time <= 20; ++time) transform("/tf", time, "start", "body", static_cast<double>(time));
    transform("/tf_static", 0, "body", "laser", 0.25);
    scan("/scan", 10);
    EXPECT_FALSE(read().at(0).scan.odometry);
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("state --base-frame body --fixed-frame start")));
    const auto stated = read({.base_frame = "body", .fixed_frame = "start"});
    EXPECT_NEAR(stated.at(0).scan.odometry.value().x, 10.0, 1e-6);
    EXPECT_EQ(stated.at(0).sensor->mount.x, 0.25);
}

TEST_F(RecordedFramesTest, OdometryBelowTheRobotIsNoted) {
    for (RosTime time = 0; time <= 20; ++time) transform("/tf", time, "base", "odom", -static_cast<double>(time));
    transform("/tf_static", 0, "base", "laser", 0.25);
    scan("/scan", 10);
    EXPECT_FALSE(read().at(0).scan.odometry);
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("state --fixed-frame odom")));
    EXPECT_NEAR(read({.fixed_frame = "odom"}).at(0).scan.odometry.value().x, 10.0, 1e-6);
    EXPECT_THAT(refused({.fixed_frame = "laser"}), HasSubstr("no transforms lead from it")) << "it does not move";
    EXPECT_THAT(refused({.fixed_frame = "base"}), HasSubstr("no transforms lead from it"));
}

TEST_F(RecordedFramesTest, AMountIsAskedForIfItIsNotKnownAtTheTimesOfScans) {
    transform("/tf", 0, "base", "laser", 0.25);
    for (RosTime time = 0; time <= 20; ++time) transform("/tf", time, "odom", "base", static_cast<double>(time));
    scan("/scan", 10);
    EXPECT_THAT(refused(), HasSubstr("1 after the last pose; state the mount with --mount X,Y,YAW"));
}

TEST_F(RecordedFramesTest, WhatElseCanBeUsedIsSaidIfMostScansHaveNoPlace) {
    transform("/tf", 0, "odom", "base", 0.0);
    transform("/tf", 30, "odom", "base", 1.0);
    transform("/tf_static", 0, "base", "laser", 0.0);
    for (RosTime time = 0; time <= 30; time += 5) {
        scan("/scan", time);
        odometry("/wheels", time, 3.0);
    }
    EXPECT_EQ(read().size(), 2U);
    EXPECT_THAT(plan_.notes, Contains(HasSubstr("5 of 7 scans are skipped, because it is not known where they were "
                                                "taken; try --odom-topic /wheels or --poses none")));
    EXPECT_EQ(read({.odom_topic = "/wheels"}).size(), 7U);
    EXPECT_EQ(plan_.notes.size(), 0U);
}

} // namespace
} // namespace scanloom::robot
