#include "robot_client/app/info.hpp"
#include "robot_client/ros/recorded_scans.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/ros_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::flat;

constexpr RosTime kBegin = 1'600'000'000'000'000'000;
constexpr RosTime kTenth = 100'000'000;

/// What a robot records: each 0.1 s its odometry at x = 0.1 m times the count, each 0.2 s a scan in between.
struct Recorder {
    std::string laser_frame = "laser";
    bool has_transforms = true; // else /odom
    bool has_map = false;
    bool has_mount = true;
    std::vector<RosTransform> statics; // more of them, at the beginning
    std::string second_frame;          // of a second laser with half the scans

    /// Writes a bag. @return its path
    [[nodiscard]] std::filesystem::path bag(const TemporaryDirectory& directory) const {
        testing_support::BagWriter writer;
        return write(directory.path() / "recording", writer, MessageEncoding::kRos1);
    }

    /// Writes the same as MCAP. @return its path
    [[nodiscard]] std::filesystem::path mcap(const TemporaryDirectory& directory) const {
        testing_support::McapWriter writer;
        return write(directory.path() / "recording2", writer, MessageEncoding::kCdr);
    }

    template <class Writer>
    [[nodiscard]] std::filesystem::path write(const std::filesystem::path& path, Writer& writer,
                                              MessageEncoding encoding) const {
        const auto scan_topic = writer.connect("/scan", "sensor_msgs/LaserScan");
        const auto second = writer.connect("/second", "sensor_msgs/LaserScan");
        const auto odom = writer.connect("/odom", "nav_msgs/Odometry");
        const auto tf = writer.connect("/tf", "tf2_msgs/TFMessage");
        const auto tf_static = writer.connect("/tf_static", "tf2_msgs/TFMessage");
        writer.write(tf_static, kBegin, testing_support::transform_bytes(statics, encoding));
        for (int n = 0; n < count; ++n) {
            const RosTime time = kBegin + n * kTenth;
            const auto pose = flat(time, "odom", "base", 0.1 * n);
            if (!has_transforms) writer.write(odom, time, testing_support::odometry_bytes(pose, encoding));
            std::vector<RosTransform> transforms;
            if (has_transforms) transforms.push_back(pose);
            if (has_map) transforms.push_back(flat(time, "map", "odom", 100.0));
            if (!transforms.empty()) writer.write(tf, time, testing_support::transform_bytes(transforms, encoding));
            if (n == count / 2 && has_mount) { // late, as the statics of a split recording may be
                const auto bytes = testing_support::transform_bytes({flat(0, "base", "laser", 0.25)}, encoding);
                writer.write(tf_static, time, bytes);
            }
            const RosLaserScan scan{{time + kTenth / 2, laser_frame},
                                    -1.0F,
                                    1.0F,
                                    0.5F,
                                    0.0F,
                                    0.1F,
                                    0.1F,
                                    10.0F,
                                    std::vector<float>(5, 1.0F + 0.01F * static_cast<float>(n))};
            if (n % 2 == 0) writer.write(scan_topic, time, testing_support::laser_bytes(scan, encoding));
            if (second_frame.empty() || n % 4 != 0) continue;
            RosLaserScan other = scan;
            other.header.frame = second_frame;
            writer.write(second, time, testing_support::laser_bytes(other, encoding));
        }
        std::ofstream(path, std::ios::binary) << writer.finish().file;
        return path;
    }

    int count = 20; // moments
};

std::vector<Observation> all_of(RecordedScans& scans) {
    std::vector<Observation> all;
    while (auto one = scans.next().value()) all.push_back(std::move(*one));
    return all;
}

class RecordedScansTest : public testing::Test {
protected:
    std::vector<Observation> read(const Recorder& recorder, const RecordingOptions& options = {}) {
        auto scans = RecordedScans::open(recorder.bag(directory_), options);
        EXPECT_TRUE(scans) << scans.error().message;
        if (!scans) return {};
        plan_ = scans->plan();
        remarks_ = scans->remarks();
        return all_of(*scans);
    }

    std::string refused(const Recorder& recorder, const RecordingOptions& options = {}) {
        const auto scans = RecordedScans::open(recorder.bag(directory_), options);
        return scans ? "" : scans.error().message;
    }

    TemporaryDirectory directory_;
    RecordingPlan plan_;
    std::string remarks_;
};

TEST_F(RecordedScansTest, ScansHaveThePosesAndMountsOfTheTransforms) {
    const auto all = read({});
    EXPECT_EQ(plan_.poses, Poses::kOdometry);
    EXPECT_EQ(plan_.base_frame, "base");
    EXPECT_EQ(plan_.fixed_frame, "odom");
    ASSERT_EQ(all.size(), 10U);
    for (std::size_t n = 0; n < all.size(); ++n) {
        const auto& [sensor, scan] = all[n];
        EXPECT_NEAR(scan.odometry.value().x, 0.2 * static_cast<double>(n) + 0.05, 1e-6);
        EXPECT_FALSE(scan.pose);
        EXPECT_NEAR(scan.stamp, 1.6e9 + 0.2 * static_cast<double>(n) + 0.05, 1e-6);
        EXPECT_EQ(scan.ranges.size(), 5U);
        EXPECT_EQ(sensor->mount, (Pose2{0.25, 0.0, 0.0}));
        EXPECT_EQ(sensor->name, "/scan");
    }
    EXPECT_THAT(plan_.notes, testing::IsEmpty());
}

TEST_F(RecordedScansTest, PosesAreInTheMapIfThereIsOne) {
    const auto all = read({.has_map = true});
    EXPECT_EQ(plan_.poses, Poses::kMap);
    EXPECT_NEAR(all.at(1).scan.pose.value().x, 100.25, 1e-6);
    const auto odometry = read({.has_map = true}, {.poses = Poses::kOdometry});
    EXPECT_NEAR(odometry.at(1).scan.odometry.value().x, 0.25, 1e-6);
    const auto alone = read({.has_map = true}, {.poses = Poses::kNone});
    EXPECT_FALSE(alone.at(1).scan.pose || alone.at(1).scan.odometry);
    EXPECT_EQ(alone.at(1).sensor->mount.x, 0.25) << "the mount is known all the same";
}

TEST_F(RecordedScansTest, OdometryAndTransformsGiveEqualScans) {
    const auto by_transforms = read({}, {.mounts = {{"", {-0.064, 0.0, 0.0}}}});
    EXPECT_THAT(plan_.notes, ElementsAre("/scan: --mount replaces the mount of the transforms"));
    const auto fingerprint = plan_.fingerprint;
    const auto by_topic = read({.has_transforms = false, .has_mount = false}, {.mounts = {{"", {-0.064, 0.0, 0.0}}}});
    EXPECT_EQ(plan_.odom_topic, "/odom");
    EXPECT_EQ(plan_.fingerprint, fingerprint);
    ASSERT_EQ(by_topic.size(), by_transforms.size());
    for (std::size_t n = 0; n < by_topic.size(); ++n) {
        EXPECT_EQ(by_topic[n].scan, by_transforms[n].scan);
        EXPECT_EQ(*by_topic[n].sensor, *by_transforms[n].sensor);
    }
}

TEST_F(RecordedScansTest, BagAndMcapGiveEqualScans) {
    const Recorder recorder{.has_map = true};
    const auto from_bag = read(recorder);
    auto scans = RecordedScans::open(recorder.mcap(directory_), {}).value();
    EXPECT_EQ(scans.plan().fingerprint, plan_.fingerprint);
    const auto from_mcap = all_of(scans);
    ASSERT_EQ(from_mcap.size(), from_bag.size());
    for (std::size_t n = 0; n < from_mcap.size(); ++n) EXPECT_EQ(from_mcap[n].scan, from_bag[n].scan);
}

TEST_F(RecordedScansTest, AnUnknownMountOfTheOnlyLaserIsZeroAndNoted) {
    const auto all = read({.has_transforms = false, .has_mount = false});
    EXPECT_EQ(all.at(0).sensor->mount, Pose2());
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("state it with --mount /scan=X,Y,YAW")));
}

/// Many robots have no transform to their laser.
TEST_F(RecordedScansTest, ALaserThatNoTransformLeadsToHasThePosesOfTheRobot) {
    const auto all = read({.laser_frame = "elsewhere"}, {.mounts = {{"", {0.5, 0.0, 0.0}}}});
    EXPECT_EQ(plan_.poses, Poses::kOdometry);
    EXPECT_EQ(plan_.notes.size(), 0U) << "--mount replaces none";
    EXPECT_EQ(all.at(0).sensor->mount, (Pose2{0.5, 0.0, 0.0}));
    EXPECT_NEAR(all.at(1).scan.odometry.value().x, 0.25, 1e-6);
}

TEST_F(RecordedScansTest, AStatedMountDoesNotTurnALaserThatIsUpsideDown) {
    RosTransform hanging = flat(0, "base", "laser", 0.25);
    hanging.T_parent_child.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    const Recorder recorder{.has_mount = false, .statics = {hanging}};
    const auto by_transforms = read(recorder);
    const auto stated = read(recorder, {.mounts = {{"", {0.5, 0.0, 0.0}}}});
    EXPECT_EQ(stated.at(0).sensor->mount, (Pose2{0.5, 0.0, 0.0}));
    EXPECT_EQ(stated.at(0).sensor->angles, by_transforms.at(0).sensor->angles);
    EXPECT_NE(stated.at(0).sensor->angles, read({}).at(0).sensor->angles);
}

/// A map frame above a charging station, or above odometry that nothing corrects, localizes no robot.
TEST_F(RecordedScansTest, AMapThatDoesNotMoveLocalizesNoRobot) {
    const auto is_by_odometry = [&](const Recorder& recorder) {
        const auto all = read(recorder);
        EXPECT_EQ(plan_.poses, Poses::kOdometry);
        EXPECT_EQ(plan_.fixed_frame, "odom");
        EXPECT_NEAR(all.at(1).scan.odometry.value_or(Pose2{}).x, 0.25, 1e-6);
    };
    is_by_odometry({.statics = {flat(0, "map", "odom", 7.0)}});
    is_by_odometry({.has_transforms = false, .statics = {flat(0, "map", "dock", 7.0)}});
    is_by_odometry({.has_transforms = false, .statics = {flat(0, "map", "base", 7.0)}});
    EXPECT_EQ(read({.has_transforms = false, .statics = {flat(0, "map", "odom", 7.0)}}, {.poses = Poses::kMap}).size(),
              10U)
        << "as stated";
}

TEST_F(RecordedScansTest, ALaserWithAKnownMountIsUsedAlsoIfItHasFewerScans) {
    EXPECT_EQ(read({.laser_frame = "elsewhere", .second_frame = "laser"}).size(), 5U);
    EXPECT_EQ(plan_.poses, Poses::kOdometry);
    EXPECT_EQ(remarks_, "skipped: 10 mount unknown");
}

TEST_F(RecordedScansTest, LasersWithoutAKnownMountAreLeftOut) {
    EXPECT_EQ(read({.second_frame = "other"}).size(), 10U);
    EXPECT_EQ(remarks_, "skipped: 5 mount unknown");
    EXPECT_THAT(plan_.notes, ElementsAre(HasSubstr("/second: its 5 scans are left out")));
    const auto both = read({.second_frame = "other"}, {.mounts = {{"/second", {0.0, 0.0, 3.0}}}});
    EXPECT_EQ(both.size(), 15U);
    EXPECT_EQ(std::ranges::count(both, 1U, [](const Observation& one) { return one.sensor->id; }), 5);
    EXPECT_EQ(remarks_, "");
    EXPECT_EQ(read({.has_mount = false, .second_frame = "other"}).size(), 10U)
        << "none is known: the one with most scans";
    EXPECT_EQ(remarks_, "skipped: 5 mount unknown");
}

TEST_F(RecordedScansTest, ASecondTopicInTheFrameOfAnotherIsLeftOutUnlessItIsChosen) {
    EXPECT_EQ(read({.second_frame = "laser"}).size(), 10U);
    EXPECT_EQ(remarks_, "skipped: 5 in the frame of another topic");
    EXPECT_EQ(read({.second_frame = "laser"}, {.topics = {"/second"}}).size(), 5U);
    EXPECT_EQ(remarks_, "skipped: 10 not a --topic");
}

TEST_F(RecordedScansTest, ScansOutsideTheTimeOfTheTransformsAreCounted) {
    Recorder recorder;
    testing_support::BagWriter writer;
    const auto tf = writer.connect("/tf", "tf2_msgs/TFMessage");
    const auto scans = writer.connect("/scan", "sensor_msgs/LaserScan");
    for (const RosTime n : {0, 1, 2, 40, 41, 42}) {
        const auto pose = flat(kBegin + n * kTenth, "odom", "laser", static_cast<double>(n));
        writer.write(tf, kBegin, testing_support::transform_bytes({pose}));
    }
    for (const RosTime half : {-1, 1, 5, 83, 86}) {
        const RosLaserScan scan{{kBegin + half * kTenth / 2, "laser"}, 0, 1, 1, 0, 0, 0, 9, {1.0F, 2.0F}};
        writer.write(scans, kBegin, testing_support::laser_bytes(scan));
    }
    writer.write(scans, kBegin, "no scan");
    const auto path = directory_.path() / "recording";
    std::ofstream(path, std::ios::binary) << writer.finish().file;
    auto opened = RecordedScans::open(path, {}).value();
    EXPECT_EQ(opened.remarks(), "skipped: 1 after the last pose, 1 before the first pose, 1 in a hole of the poses, "
                                "1 malformed messages");
    EXPECT_EQ(all_of(opened).size(), 2U);
}

TEST_F(RecordedScansTest, WhatTheOptionsNameMustBeThere) {
    EXPECT_THAT(refused({}, {.topics = {"/nothing"}}), HasSubstr("--topic /nothing: the recording has no scans of this "
                                                                 "topic; it has: /scan"));
    EXPECT_THAT(refused({}, {.mounts = {{"/nothing", {}}}}), HasSubstr("--mount /nothing"));
    EXPECT_THAT(refused({}, {.odom_topic = "/wheels"}), HasSubstr("it has: none"));
    EXPECT_THAT(refused({}, {.base_frame = "body"}), HasSubstr("frames from the laser up are: laser, base, odom"));
    EXPECT_THAT(refused({}, {.fixed_frame = "vicon"}), HasSubstr("frames from that up are: base, odom"));
    EXPECT_THAT(refused({}, {.poses = Poses::kMap}), HasSubstr("no frame named map is above the robot's frame base; "
                                                               "use --poses odometry"));
    EXPECT_THAT(refused({.has_transforms = false, .has_mount = false, .second_frame = "x"}, {.mounts = {{"", {}}}}),
                HasSubstr("the recording has 2 lasers; say whose mount it is: --mount /scan=X,Y,YAW"));
    const Recorder without{.laser_frame = "elsewhere", .has_mount = false};
    EXPECT_THAT(refused(without, {.poses = Poses::kOdometry, .base_frame = "elsewhere"}),
                HasSubstr("no transforms lead from a frame of odometry to the robot's frame elsewhere; name"));
}

TEST_F(RecordedScansTest, FramesOfTheOptionsAreUsed) {
    const auto all = read({.has_map = true}, {.poses = Poses::kMap, .base_frame = "laser", .fixed_frame = "odom"});
    EXPECT_EQ(all.at(0).sensor->mount, Pose2());
    EXPECT_NEAR(all.at(0).scan.pose.value().x, 0.3, 1e-6);
}

TEST_F(RecordedScansTest, AChangedFileIsRefused) {
    Recorder recorder;
    recorder.count = 20'000; // more than is read ahead
    const auto path = recorder.bag(directory_);
    auto scans = RecordedScans::open(path, {}).value();
    testing_support::BagWriter writer;
    std::ofstream(path, std::ios::binary) << writer.finish().file;
    auto next = scans.next(); // a part of the file may be in memory already
    while (next && *next) next = scans.next();
    EXPECT_EQ(next.error().code, Errc::kConflict);
}

TEST_F(RecordedScansTest, InfoListsTopicsAndTheCommand) {
    const auto path = Recorder{.second_frame = "other"}.bag(directory_);
    auto found = survey(path).value();
    const auto plan = robot::plan(found, {});
    const std::string text = info_text(
        {.file = "a'.bag", .scan_arguments = " --poses 'odometry'", .ros_arguments = " --topic '/scan'"}, found, plan);
    EXPECT_THAT(text, HasSubstr("a'.bag: 1.9 s, from 2020-09-13 12:26:40 UTC to 2020-09-13 12:26:41 UTC\n"));
    EXPECT_THAT(text, HasSubstr("/scan       sensor_msgs/LaserScan         10       5.0  laser\n"));
    EXPECT_THAT(text, HasSubstr("poses: odometry, of base in odom, by the transforms\n"
                                "scans: 10 of 15 can be sent; skipped: 5 mount unknown\n"));
    EXPECT_THAT(text, HasSubstr("replay it with: scanloom-robot --server HOST:7447 --session NAME --robot NAME --poses "
                                R"('odometry' replay 'a'\''.bag' --topic '/scan')"
                                "\n"));
}

TEST_F(RecordedScansTest, ADamagedFileGivesItsOtherScansAndSaysWhatIsLost) {
    const auto path = Recorder().bag(directory_);
    const auto whole = RecordedScans::open(path, {});
    EXPECT_EQ(whole->losses().count, 0U);
    EXPECT_THAT(texts_of(whole->losses()), testing::IsEmpty());
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * 2 / 3);
    auto cut = RecordedScans::open(path, {}).value();
    const auto sent = all_of(cut).size();
    EXPECT_GT(sent, 0U);
    EXPECT_LT(sent, *whole->scan_count());
    EXPECT_GT(cut.losses().count, 0U);
    EXPECT_THAT(texts_of(cut.losses()), testing::Contains(testing::StartsWith("lost at byte ")));
    EXPECT_THAT(texts_of({5, std::vector<RecordingLoss>(5)}),
                testing::ElementsAre(testing::_, testing::_, testing::_, "lost: 2 more parts"));
}

} // namespace
} // namespace scanloom::robot
