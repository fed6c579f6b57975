#include "tests/unit/server/sessions/session_fixture.hpp"

#include <numbers>
#include <string>
#include <vector>

/// Which poses a session accepts from its robots.
namespace scanloom::sessions {
namespace {

using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

Scan scan_with(std::uint64_t seq, std::optional<Pose2> pose, std::optional<Pose2> odometry) {
    Scan scan = random_scan(1, seq);
    scan.pose = pose;
    scan.odometry = odometry;
    return scan;
}

Sensor ring_of_sonars() {
    Sensor sensor;
    sensor.id = 3;
    sensor.kind = SensorKind::kSonar;
    sensor.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 4, 8};
    sensor.aperture = 0.5;
    sensor.range_max = 3.0;
    return sensor;
}

class PosesTest : public SessionTest {
protected:
    Join join_with(Poses poses, const std::string& robot = "r", const std::string& source = {}) {
        return begin_join(robot, source, std::nullopt, poses);
    }

    /// Joins a robot and describes its sensor.
    std::shared_ptr<RecordedLink> joined(Poses poses, const Sensor& sensor = small_laser(),
                                         const std::string& robot = "r") {
        const auto join = join_with(poses, robot);
        EXPECT_TRUE(join.answer->has_value() && join.answer->value()) << robot;
        session_->submit(join.link, sensor, 0);
        run();
        return join.link;
    }

    /// Returns the message with which the session refuses a robot.
    std::string refusal_of(const Join& join) {
        if (!join.answer->has_value() || join.answer->value()) return "accepted";
        EXPECT_EQ(join.answer->value().error().code, Errc::kConflict);
        return join.answer->value().error().message;
    }

    /// Returns the message with which the session refuses a scan.
    std::string refusal_of(const std::shared_ptr<RecordedLink>& link, const Scan& scan) {
        session_->submit(link, {scan}, 0);
        run();
        if (link->failures.empty()) return "accepted";
        EXPECT_EQ(link->failures[0].code, Errc::kInvalidField);
        return link->failures[0].message;
    }

    std::string refusal_of(Poses poses, const Scan& scan) { return refusal_of(joined(poses), scan); }
};

constexpr Pose2 kPlace{1.0, 2.0, 0.5};

TEST_F(PosesTest, RobotWithPosesMustSendThem) {
    EXPECT_THAT(refusal_of(Poses::kMap, scan_with(1, std::nullopt, kPlace)),
                StartsWith("scan_batch.scans[0].pose is absent; send where the robot was"));
    EXPECT_EQ(refusal_of(Poses::kMap, scan_with(1, kPlace, std::nullopt)), "accepted");
    EXPECT_EQ(refusal_of(Poses::kMap, scan_with(2, kPlace, kPlace)), "accepted");
}

TEST_F(PosesTest, RobotWithOdometryMustSendItAlone) {
    EXPECT_THAT(refusal_of(Poses::kOdometry, scan_with(1, kPlace, kPlace)),
                StartsWith("scan_batch.scans[0].pose is set, but hello.poses says"));
    EXPECT_THAT(refusal_of(Poses::kOdometry, scan_with(1, std::nullopt, std::nullopt)),
                StartsWith("scan_batch.scans[0].odometry is absent, but hello.poses says"));
    EXPECT_EQ(refusal_of(Poses::kOdometry, scan_with(1, std::nullopt, kPlace)), "accepted");
}

TEST_F(PosesTest, RobotWithoutPosesMustSendNeither) {
    EXPECT_THAT(refusal_of(Poses::kNone, scan_with(1, kPlace, std::nullopt)),
                StartsWith("scan_batch.scans[0].pose is set, but hello.poses says"));
    EXPECT_THAT(refusal_of(Poses::kNone, scan_with(1, std::nullopt, kPlace)),
                StartsWith("scan_batch.scans[0].odometry is set, but hello.poses says"));
    EXPECT_EQ(refusal_of(Poses::kNone, scan_with(1, std::nullopt, std::nullopt)), "accepted");
}

TEST_F(PosesTest, SonarsAloneNeedOdometry) {
    Scan scan = scan_with(1, std::nullopt, std::nullopt);
    scan.sensor = ring_of_sonars().id;
    scan.ranges.resize(8);
    EXPECT_THAT(refusal_of(joined(Poses::kNone, ring_of_sonars()), scan),
                StartsWith("scan_batch.scans[0].sensor is a ring of sonars of a robot without laser and odometry"));
    const auto with_laser = joined(Poses::kNone, ring_of_sonars());
    session_->submit(with_laser, small_laser(), 0);
    EXPECT_EQ(refusal_of(with_laser, scan), "accepted");
}

TEST_F(PosesTest, PosesAreNotEstimatedWithALaserFarFromItsRobot) {
    Sensor far = small_laser();
    far.mount = {12.0, -16.1, 0.0};
    EXPECT_THAT(joined(Poses::kMap, far, "sends poses")->failures, IsEmpty());
    const auto link = joined(Poses::kOdometry, far, "does not");
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_EQ(link->failures[0].message, "sensor_description.mount is 20.1 m from the robot's origin; poses are "
                                         "estimated with lasers within 20 m of it: give the mount in metres, in the "
                                         "robot frame");
    far.mount.y = -15.9;
    EXPECT_THAT(joined(Poses::kNone, far, "neither")->failures, IsEmpty());
}

TEST_F(PosesTest, ScansBeforeOneWithTheWrongPoseAreKept) {
    const auto link = joined(Poses::kOdometry);
    session_->submit(link, {scan_with(1, std::nullopt, kPlace), scan_with(2, kPlace, kPlace)}, 10);
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_THAT(link->failures[0].message, StartsWith("scan_batch.scans[1].pose is set"));
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 1U);
    EXPECT_EQ(logged().back(), LogEntry(ScanTaken{0, scan_with(1, std::nullopt, kPlace)})) << "as it was sent";
}

TEST_F(PosesTest, NoRobotSendsPosesInAFrameThatTheServerEstimated) {
    const auto link = joined(Poses::kOdometry);
    const auto early = joined(Poses::kMap, small_laser(), "early");
    EXPECT_EQ(refusal_of(link, scan_with(1, std::nullopt, kPlace)), "accepted");
    EXPECT_EQ(refusal_of(join_with(Poses::kMap, "other")),
              "hello.poses: robot 'other' sends poses in the map's frame, but the map of session 'lab' began with "
              "estimated poses of robot 'r', and only the server knows their frame; use --poses odometry or none, or "
              "another session");
    session_->submit(early, {scan_with(1, kPlace, std::nullopt)}, 0);
    run();
    ASSERT_THAT(early->failures, SizeIs(1)) << "it joined before, but the map has begun since";
    EXPECT_EQ(early->failures[0].code, Errc::kConflict);
    EXPECT_THAT(early->failures[0].message, StartsWith("scan_batch.scans[0].pose: robot 'early' sends poses"));
    EXPECT_EQ(refusal_of(join_with(Poses::kOdometry, "second")), "accepted");
    EXPECT_EQ(refusal_of(join_with(Poses::kNone, "third")), "accepted");
}

TEST_F(PosesTest, RobotsWithEstimatedPosesJoinThoseThatSendThem) {
    EXPECT_EQ(refusal_of(joined(Poses::kMap, small_laser(), "sender"), scan_with(1, kPlace, std::nullopt)), "accepted");
    EXPECT_EQ(refusal_of(joined(Poses::kOdometry, small_laser(), "follower"), scan_with(1, std::nullopt, kPlace)),
              "accepted");
    start_session();
    EXPECT_EQ(refusal_of(joined(Poses::kMap, small_laser(), "late"), scan_with(1, kPlace, std::nullopt)), "accepted")
        << "the frame is the senders'";
    EXPECT_EQ(session_->snapshot()->robots.at(1).localization.state, LocalizationState::kUnlocated);
}

/// A robot that joined first, without scans, does not decide whose frame the map has.
TEST_F(PosesTest, TheFirstScanDecidesTheFrameAlsoAfterARestart) {
    joined(Poses::kMap, small_laser(), "early");
    EXPECT_EQ(refusal_of(joined(Poses::kOdometry), scan_with(1, std::nullopt, kPlace)), "accepted");
    start_session();
    EXPECT_THAT(refusal_of(join_with(Poses::kMap, "early")), StartsWith("hello.poses: robot 'early' sends poses"));

    id_ = log_.create_session("an unused record").value();
    start_session();
    joined(Poses::kOdometry, small_laser(), "early");
    EXPECT_EQ(refusal_of(joined(Poses::kMap), scan_with(1, kPlace, std::nullopt)), "accepted");
    start_session();
    EXPECT_EQ(refusal_of(joined(Poses::kOdometry, small_laser(), "early"), scan_with(1, std::nullopt, kPlace)),
              "accepted");
    EXPECT_EQ(refusal_of(joined(Poses::kMap), scan_with(2, kPlace, std::nullopt)), "accepted");
}

TEST_F(PosesTest, RobotContinuesWithTheSameKindOfPoses) {
    const auto link = joined(Poses::kMap);
    EXPECT_EQ(refusal_of(join_with(Poses::kOdometry)), "accepted") << "it has no scans yet";
    EXPECT_EQ(session_->snapshot()->robots.at(0).poses, Poses::kOdometry);
    EXPECT_EQ(logged().back(), LogEntry(RobotJoined{.robot = 0, .name = "r", .poses = Poses::kOdometry}));
    EXPECT_EQ(refusal_of(Poses::kOdometry, scan_with(1, std::nullopt, kPlace)), "accepted");
    const auto entries = logged().size();
    for (const auto poses : {Poses::kMap, Poses::kNone}) {
        EXPECT_THAT(refusal_of(join_with(poses)),
                    StartsWith("hello.poses: the 1 scans of robot 'r' in session 'lab' have poses of kind 'odometry', "
                               "not '" +
                               std::string(name_of(poses)) + "'; continue with the same"));
    }
    EXPECT_THAT(refusal_of(join_with(Poses::kMap, "r", "carmen:1")), StartsWith("hello.source: "));
    EXPECT_EQ(refusal_of(join_with(Poses::kOdometry)), "accepted");
    EXPECT_THAT(logged(), SizeIs(entries)) << "nothing has changed";
    start_session();
    EXPECT_THAT(refusal_of(join_with(Poses::kMap)), StartsWith("hello.poses: ")) << "also after a restart";
}

TEST_F(PosesTest, CheckpointsContainTheEstimationIfThereIsOne) {
    for (const bool is_estimated : {false, true}) {
        id_ = log_.create_session("an unused record").value();
        start_session();
        const auto scan = is_estimated ? scan_with(1, std::nullopt, kPlace) : scan_with(1, kPlace, std::nullopt);
        EXPECT_EQ(refusal_of(is_estimated ? Poses::kOdometry : Poses::kMap, scan), "accepted");
        session_->close({Errc::kShuttingDown, "bye"}, [] {});
        run();
        const auto parts = store::checkpoint_of(log_, id_).value();
        EXPECT_TRUE(parts.contains("head"));
        EXPECT_EQ(parts.contains("head/estimation"), is_estimated);
        EXPECT_EQ(parts.contains("slam/state/00000000/00000000"), is_estimated);
    }
}

} // namespace
} // namespace scanloom::sessions
