#include "common/scan/limits.hpp"
#include "common/wire/messages.hpp"
#include "tests/unit/common/wire/example_messages.hpp"
#include "tests/unit/common/wire/refusals.hpp"

#include "scanloom/v1/frame.pb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

/// Every field value that can be invalid in a frame, and the error that names the field.
namespace scanloom::wire {
namespace {

TEST(BadHello, IsRefusedByFieldName) {
    const InvalidCase<Hello> kCases[] = {
        {[](Hello& h) { h.protocol_version = 0; }, "hello.protocol_version is 0;", Errc::kUnsupportedVersion},
        {[](Hello& h) { h.protocol_version = 2; }, "hello.protocol_version is 2;", Errc::kUnsupportedVersion},
        {[](Hello& h) { h.robot = ""; }, "hello.robot is not a valid name"},
        {[](Hello& h) { h.robot = "a b"; }, "hello.robot is not a valid name"},
        {[](Hello& h) { h.robot = std::string(65, 'a'); }, "hello.robot is not a valid name"},
        {[](Hello& h) { h.robot = std::string("a\0b", 3); }, "hello.robot is not a valid name"},
        {[](Hello& h) { h.session = ""; }, "hello.session is not a valid name"},
        {[](Hello& h) { h.session = "../etc"; }, "hello.session is not a valid name"},
        {[](Hello& h) { h.session = "caf\xc3\xa9"; }, "hello.session is not a valid name"},
        {[](Hello& h) { h.client = std::string(129, 'c'); }, "hello.client has 129 bytes", Errc::kTooLarge},
        {[](Hello& h) { h.client = "a\x1b[2J"; }, "hello.client holds a control character;"},
        {[](Hello& h) { h.source = std::string(65, 's'); }, "hello.source has 65 bytes, at most 64", Errc::kTooLarge},
        {[](Hello& h) { h.source = "carmen:\n"; }, "hello.source holds a control character;"},
        {[](Hello& h) { h.source = "carmen:\x7f"; }, "hello.source holds a control character;"},
        {[](Hello& h) { h.body_radius = 0.0; }, "hello.body_radius is 0 m; it must be more than 0 and at most 5"},
        {[](Hello& h) { h.body_radius = -0.2; }, "hello.body_radius is -0.2 m;"},
        {[](Hello& h) { h.body_radius = 5.01; }, "hello.body_radius is 5.01 m;"},
        {[](Hello& h) { h.body_radius = std::nan(""); }, "hello.body_radius is nan m;"},
        {[](Hello& h) { h.body_radius = HUGE_VAL; }, "hello.body_radius is inf m;"},
    };
    for (const auto& invalid : kCases) {
        Hello hello = example_hello();
        invalid.make_invalid(hello);
        expect_refused(body_of(hello), invalid.code, invalid.beginning);
    }
}

TEST(BadHello, UnknownPosesAreRefused) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_hello())));
    for (const int poses : {3, -1}) {
        frame.mutable_hello()->set_poses(static_cast<v1::Poses>(poses));
        expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                       "hello.poses is " + std::to_string(poses) + ", which");
    }
}

TEST(BadHello, NameThatIsNotUtf8IsMalformed) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_hello())));
    std::string body = frame.SerializeAsString();
    body.replace(body.find("robot-1"), 7, "\xff\xfe\xff\xfe\xff\xfe\xff");
    expect_refused(body, Errc::kMalformed, "");
}

TEST(BadSensor, IsRefusedByFieldName) {
    const InvalidCase<Sensor> kCases[] = {
        {[](Sensor& s) { s.id = 64; }, "sensor_description.sensor is 64;"},
        {[](Sensor& s) { s.name = std::string(65, 'n'); }, "sensor_description.name has 65 bytes", Errc::kTooLarge},
        {[](Sensor& s) { s.mount.x = kNan; }, "sensor_description.mount.x is nan;"},
        {[](Sensor& s) { s.mount.y = -kInfinity; }, "sensor_description.mount.y is -inf;"},
        {[](Sensor& s) { s.mount.yaw = kInfinity; }, "sensor_description.mount.yaw is inf;"},
        {[](Sensor& s) { s.aperture = kNan; }, "sensor_description.aperture is nan;"},
        {[](Sensor& s) { s.aperture = -0.1; }, "sensor_description.aperture is -0.1;"},
        {[](Sensor& s) { s.aperture = 3.2; }, "sensor_description.aperture is 3.2;"},
        {[](Sensor& s) { s.range_min = kNan; }, "sensor_description.range_min is nan;"},
        {[](Sensor& s) { s.range_min = -1.0; }, "sensor_description.range_min is -1;"},
        {[](Sensor& s) { s.range_min = kInfinity; }, "sensor_description.range_min is inf;"},
        {[](Sensor& s) { s.range_max = kNan; }, "sensor_description.range_max is nan;"},
        {[](Sensor& s) { s.range_max = kInfinity; }, "sensor_description.range_max is inf;"},
        {[](Sensor& s) { s.range_max = s.range_min; }, "sensor_description.range_max is 0.0625;"},
        {[](Sensor& s) { s.range_max = 1001.0; }, "sensor_description.range_max is 1001;"},
    };
    for (const auto& invalid : kCases) {
        Sensor sensor = example_sensor();
        invalid.make_invalid(sensor);
        expect_refused(body_of(sensor), invalid.code, invalid.beginning);
    }
}

TEST(BadSensor, KindMustBeKnown) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_sensor())));
    for (const int kind : {0, 3, -1}) {
        frame.mutable_sensor_description()->set_kind(static_cast<v1::SensorKind>(kind));
        expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                       "sensor_description.kind is " + std::to_string(kind) + ";");
    }
}

TEST(SensorDescription, WithoutMountHasIdentityMount) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_sensor())));
    frame.mutable_sensor_description()->clear_mount();
    const auto decoded = decode(frame.SerializeAsString());
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(std::get<Sensor>(*decoded).mount, Pose2{});
}

struct InvalidAngles {
    BeamAngles angles;
    const char* message;
    Errc code = Errc::kInvalidField;
};

const InvalidAngles kInvalidAngles[] = {
    {UniformAngles{kNan, 0.1, 3}, "angles.uniform.first is nan;"},
    {UniformAngles{kInfinity, 0.1, 3}, "angles.uniform.first is inf;"},
    {UniformAngles{100.0, 0.1, 3}, "angles.uniform.first is 100;"},
    {UniformAngles{0.0, kNan, 3}, "angles.uniform.increment is nan;"},
    {UniformAngles{0.0, -kInfinity, 3}, "angles.uniform.increment is -inf;"},
    {UniformAngles{0.0, 0.0, 3}, "angles.uniform.increment is 0;"},
    {UniformAngles{0.0, 3.2, 3}, "angles.uniform spans 6.400 rad over 3 beams, more than a full turn"},
    {UniformAngles{0.0, -3.2, 3}, "angles.uniform spans 6.400 rad over 3 beams, more than a full turn"},
    {UniformAngles{0.0, 0.1, 0}, "angles describe 0 beams;"},
    {UniformAngles{0.0, 1e-5, 4097}, "angles describe 4097 beams, at most 4096", Errc::kTooLarge},
    {UniformAngles{0.0, 1e-9, 4'294'967'295U}, "angles describe 4294967295 beams, at most 4096", Errc::kTooLarge},
    {ExplicitAngles{}, "angles describe 0 beams;"},
    {ExplicitAngles(4097, 0.1), "angles describe 4097 beams, at most 4096", Errc::kTooLarge},
    {ExplicitAngles{0.0, kNan, 0.1}, "angles.explicit.angles[1] is nan;"},
    {ExplicitAngles{0.0, 0.1, kInfinity}, "angles.explicit.angles[2] is inf;"},
    {ExplicitAngles{-50.0, 0.1, 0.2}, "angles.explicit.angles[0] is -50;"},
    {SteppedAngles{0.1, {}}, "angles describe 0 beams;"},
    {SteppedAngles{0.1, std::vector<std::int32_t>(4097, 1)}, "angles describe 4097 beams, at most 4096",
     Errc::kTooLarge},
    {SteppedAngles{0.0, {0, 1, 2}}, "angles.stepped.unit is 0;"},
    {SteppedAngles{kNan, {0, 1, 2}}, "angles.stepped.unit is nan;"},
    {SteppedAngles{-kInfinity, {0, 1, 2}}, "angles.stepped.unit is -inf;"},
    {SteppedAngles{0.5, {0, 1, -100}}, "angles.stepped.deltas lead beam 2 to -100 steps of 0.5, which is -50;"},
    {SteppedAngles{1e300, {0, 2'000'000'000, 1}},
     "angles.stepped.deltas lead beam 1 to 2000000000 steps of 1e+300, which is inf;"},
};

TEST(BadAngles, SensorAnglesAreRefusedByFieldName) {
    for (const auto& invalid : kInvalidAngles) {
        Sensor sensor = example_sensor();
        sensor.angles = invalid.angles;
        expect_refused(body_of(sensor), invalid.code, std::string("sensor_description.") + invalid.message);
    }
}

TEST(BadAngles, ScanAnglesAreRefusedByFieldNameAndIndex) {
    for (const auto& invalid : kInvalidAngles) {
        ScanBatch batch = example_batch();
        batch.scans[2].angles = invalid.angles;
        expect_refused(body_of(batch), invalid.code, std::string("scan_batch.scans[2].") + invalid.message);
    }
}

TEST(BadAngles, StepsBeyond32BitsAreRefused) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_sensor())));
    auto& stepped = *frame.mutable_sensor_description()->mutable_angles()->mutable_stepped();
    stepped.set_unit(1e-12);
    stepped.add_deltas(INT32_MAX);
    EXPECT_TRUE(decode(frame.SerializeAsString()));
    for (const std::int32_t once_more : {1, INT32_MAX}) {
        stepped.clear_deltas();
        for (const std::int32_t delta : {INT32_MAX, once_more}) stepped.add_deltas(delta);
        expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                       "sensor_description.angles.stepped.deltas lead beam 1 to ");
    }
    stepped.clear_deltas();
    for (const std::int32_t delta : {INT32_MIN, -1}) stepped.add_deltas(delta);
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                   "sensor_description.angles.stepped.deltas lead beam 1 to -2147483649 steps; 32 bits must hold");
}

TEST(BadAngles, MissingAnglesAreRefused) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_sensor())));
    frame.mutable_sensor_description()->clear_angles();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                   "sensor_description.angles are neither uniform, explicit nor stepped");
    ASSERT_TRUE(frame.ParseFromString(body_of(example_batch())));
    frame.mutable_scan_batch()->mutable_scans(1)->mutable_angles()->Clear();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                   "scan_batch.scans[1].angles are neither uniform, explicit nor stepped");
}

TEST(BadScan, IsRefusedByFieldNameAndIndex) {
    const InvalidCase<Scan> kCases[] = {
        {[](Scan& s) { s.seq = 0; }, "seq is 0;"},
        {[](Scan& s) { s.stamp = kNan; }, "stamp is nan;"},
        {[](Scan& s) { s.stamp = kInfinity; }, "stamp is inf;"},
        {[](Scan& s) { s.pose->x = kNan; }, "pose.x is nan;"},
        {[](Scan& s) { s.pose->x = kInfinity; }, "pose.x is inf;"},
        {[](Scan& s) { s.pose->y = -kInfinity; }, "pose.y is -inf;"},
        {[](Scan& s) { s.pose->yaw = kNan; }, "pose.yaw is nan;"},
        {[](Scan& s) { s.pose->x = 1.1e6; }, "pose.x is 1100000;"},
        {[](Scan& s) { s.pose->y = -1e300; }, "pose.y is -1e+300;"},
        {[](Scan& s) { s.odometry->x = kNan; }, "odometry.x is nan;"},
        {[](Scan& s) { s.odometry->yaw = -kInfinity; }, "odometry.yaw is -inf;"},
        {[](Scan& s) { s.duration = kNan; }, "duration is nan;"},
        {[](Scan& s) { s.duration = -10.5; }, "duration is -10.5;"},
        {[](Scan& s) { s.ranges.clear(); }, "ranges is empty;"},
        {[](Scan& s) { s.ranges.assign(4097, 1000); }, "ranges has 4097 beams, at most 4096", Errc::kTooLarge},
        {[](Scan& s) { s.ranges.assign(100'000, 1000); }, "ranges has 100000 beams, at most 4096", Errc::kTooLarge},
        {[](Scan& s) { s.intensities.pop_back(); }, "intensities has 2 values for 3 ranges;"},
        {[](Scan& s) { s.intensities.push_back(1); }, "intensities has 4 values for 3 ranges;"},
        {[](Scan& s) { s.angles = ExplicitAngles{0.1}; }, "angles describe 1 beams, ranges has 3;"},
        {[](Scan& s) {
             s.angles = UniformAngles{0.0, 0.1, 4};
         },
         "angles describe 4 beams, ranges has 3;"},
    };
    for (const auto& invalid : kCases) {
        for (const std::size_t place : {0U, 3U}) {
            ScanBatch batch = example_batch();
            invalid.make_invalid(batch.scans[place]);
            expect_refused(body_of(batch), invalid.code,
                           "scan_batch.scans[" + std::to_string(place) + "]." + invalid.beginning);
        }
    }
}

TEST(BadScan, EmptyPoseIsTheOriginButAMissingOneIsNone) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_batch())));
    auto& scan = *frame.mutable_scan_batch()->mutable_scans(2);
    scan.mutable_pose()->Clear();
    const auto decoded = decode(frame.SerializeAsString());
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(std::get<ScanBatch>(*decoded).scans[2].pose, Pose2{}) << "an empty pose is the origin";
    scan.clear_pose();
    const auto without = decode(frame.SerializeAsString());
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_EQ(std::get<ScanBatch>(*without).scans[2].pose, std::nullopt);
}

TEST(BadBatch, EmptyOrTooLargeBatchIsRefused) {
    expect_refused(body_of(ScanBatch{}), Errc::kInvalidField, "scan_batch.scans is empty;");
    expect_refused(body_of(ScanBatch{std::vector<Scan>(kScansPerBatchMax + 1, example_scan())}), Errc::kTooLarge,
                   "scan_batch.scans has 1025 scans, at most 1024");
}

TEST(BadPlanRequest, IsRefusedByFieldName) {
    const InvalidCase<PlanRequest> kCases[] = {
        {[](PlanRequest& r) { r.start->x = kNan; }, "plan_request.start.x is nan;"},
        {[](PlanRequest& r) { r.start->y = 1.1e6; }, "plan_request.start.y is 1100000;"},
        {[](PlanRequest& r) { r.goal.x = kInfinity; }, "plan_request.goal.x is inf;"},
        {[](PlanRequest& r) { r.goal.y = -1e300; }, "plan_request.goal.y is -1e+300;"},
    };
    for (const auto& invalid : kCases) {
        PlanRequest request = example_plan_request();
        invalid.make_invalid(request);
        expect_refused(body_of(request), invalid.code, invalid.beginning);
    }
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_plan_request())));
    frame.mutable_plan_request()->clear_goal();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "plan_request.goal is absent;");
}

TEST(BadGoalRequest, IsRefusedByFieldName) {
    GoalRequest request = example_goal_request();
    request.start->y = kNan;
    expect_refused(body_of(request), Errc::kInvalidField, "goal_request.start.y is nan;");
}

TEST(BadCoverageRequest, IsRefusedByFieldName) {
    const InvalidCase<CoverageRequest> kCases[] = {
        {[](CoverageRequest& r) { r.start->x = kNan; }, "coverage_request.start.x is nan;"},
        {[](CoverageRequest& r) { r.region[1].y = kNan; }, "coverage_request.region[3] is nan;"},
        {[](CoverageRequest& r) { r.region[2].x = -2e6; }, "coverage_request.region[4] is -2000000;"},
        {[](CoverageRequest& r) {
             r.region.assign(kRegionPointsMax + 1, {1.0, 1.0});
         },
         "coverage_request.region has 4097 points, at most 4096", Errc::kTooLarge},
    };
    for (const auto& invalid : kCases) {
        CoverageRequest request = example_coverage_request();
        invalid.make_invalid(request);
        expect_refused(body_of(request), invalid.code, invalid.beginning);
    }
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_coverage_request())));
    frame.mutable_coverage_request()->mutable_region()->RemoveLast();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "coverage_request.region has 5 numbers;");
}

TEST(BadReply, InvalidPathIsRefusedByFieldName) {
    const InvalidCase<Path> kCases[] = {
        {[](Path& p) { p.points.clear(); }, "points is empty;"},
        {[](Path& p) { p.points[1].x = kNan; }, "points[2] is nan;"},
        {[](Path& p) { p.points[2].y = 1.1e6; }, "points[5] is 1100000;"},
        {[](Path& p) {
             p.points.assign(kReplyPointsMax + 1, {0.0, 0.0});
         },
         "points has 65001 points, at most 65000", Errc::kTooLarge},
        {[](Path& p) { p.length = kNan; }, "length is nan;"},
        {[](Path& p) { p.length = -1.0; }, "length is -1;"},
        {[](Path& p) { p.cost = kInfinity; }, "cost is inf;"},
    };
    for (const auto& invalid : kCases) {
        Path path = example_path();
        invalid.make_invalid(path);
        expect_refused(body_of(PlanReply{1, 2, path}), invalid.code,
                       std::string("plan_reply.path.") + invalid.beginning);
        expect_refused(body_of(GoalReply{1, 2, Goal{Exploration::kGoal, path, Point2{0.0, 0.0}}}), invalid.code,
                       std::string("goal_reply.goal.path.") + invalid.beginning);
        expect_refused(body_of(CoverageReply{1, 2, Coverage{path, 2.0, 1.0}}), invalid.code,
                       std::string("coverage_reply.coverage.path.") + invalid.beginning);
    }
}

TEST(BadReply, IsRefusedByFieldName) {
    expect_refused(body_of(CoverageReply{1, 2, Coverage{example_path(), kNan, 1.0}}), Errc::kInvalidField,
                   "coverage_reply.coverage.free_area is nan;");
    expect_refused(body_of(CoverageReply{1, 2, Coverage{example_path(), 1.0, 1.0, {{0, 0, 1}, {1, 0, 0}}, 0.05}}),
                   Errc::kInvalidField, "coverage_reply.coverage.unreachable[5] is 0;");
    expect_refused(body_of(CoverageReply{1, 2, Coverage{example_path(), 1.0, 1.0, {}, kNan}}), Errc::kInvalidField,
                   "coverage_reply.coverage.cell_size is nan;");
    expect_refused(body_of(CoverageReply{1, 2, Coverage{example_path(), 1.0, -1.0}}), Errc::kInvalidField,
                   "coverage_reply.coverage.covered_area is -1;");
    expect_refused(body_of(GoalReply{1, 2, Goal{Exploration::kGoal, example_path(), Point2{kNan, 0.0}}}),
                   Errc::kInvalidField, "goal_reply.goal.target.x is nan;");
    expect_refused(body_of(GoalReply{1, 2, Goal{Exploration::kGoal, example_path(), std::nullopt}}),
                   Errc::kInvalidField, "goal_reply.goal.exploration does not go with path and target;");
    expect_refused(body_of(GoalReply{1, 2, Goal{Exploration::kComplete, example_path(), std::nullopt}}),
                   Errc::kInvalidField, "goal_reply.goal.exploration does not go with path and target;");
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(GoalReply{1, 2, example_goal()})));
    for (const int exploration : {0, 4, -1}) {
        frame.mutable_goal_reply()->mutable_goal()->set_exploration(static_cast<v1::Exploration>(exploration));
        expect_refused(frame.SerializeAsString(), Errc::kInvalidField,
                       "goal_reply.goal.exploration is " + std::to_string(exploration) + ";");
    }
}

TEST(BadReply, MissingOutcomeIsRefused) {
    v1::Frame frame;
    frame.mutable_plan_reply()->set_id(1);
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "plan_reply.outcome is absent;");
    frame.mutable_goal_reply()->set_id(1);
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "goal_reply.outcome is absent;");
    frame.mutable_coverage_reply()->set_id(1);
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "coverage_reply.outcome is absent;");
}

TEST(CheckScan, UniformSensorAnglesMustNotExceedAFullTurn) {
    Sensor sensor = example_sensor();
    sensor.angles = UniformAngles{0.0, 2.0 * std::numbers::pi / 360.0, 180};
    Scan scan = example_scan();
    scan.angles.reset();
    for (const std::size_t beams : {1U, 179U, 360U, 361U}) {
        scan.ranges.assign(beams, 1000);
        EXPECT_TRUE(check_scan(scan, sensor)) << beams;
    }
    scan.ranges.assign(362, 1000);
    const auto refused = check_scan(scan, sensor);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kInvalidField);
    EXPECT_THAT(refused.error().message, testing::StartsWith("ranges has 362 beams, which span 6.301 rad"));
}

TEST(CheckScan, Float32IncrementMayExceedAFullTurnByOneMilliradian) {
    constexpr double kTurtleBot3 = 0.017501922324299812; // radians; 359 of them are 4.8e-6 more than a turn
    Sensor sensor = example_sensor();
    sensor.angles = UniformAngles{0.0, kTurtleBot3, 360};
    EXPECT_TRUE(decode(body_of(sensor)));
    Scan scan = example_scan();
    scan.angles.reset();
    scan.ranges.assign(360, 1000);
    EXPECT_TRUE(check_scan(scan, sensor));
    sensor.angles = UniformAngles{0.0, (2.0 * std::numbers::pi + 0.99e-3) / 359.0, 360};
    EXPECT_TRUE(check_scan(scan, sensor));
    sensor.angles = UniformAngles{0.0, (2.0 * std::numbers::pi + 1.01e-3) / 359.0, 360};
    EXPECT_FALSE(check_scan(scan, sensor));
    EXPECT_FALSE(decode(body_of(sensor)));
}

TEST(CheckScan, ExplicitSensorAnglesNeedOneRangeEach) {
    Sensor sensor = example_sensor();
    sensor.angles = ExplicitAngles{0.1, 0.2, 0.4};
    Scan scan = example_scan();
    scan.angles.reset();
    EXPECT_TRUE(check_scan(scan, sensor));
    scan.ranges.pop_back();
    const auto refused = check_scan(scan, sensor);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::StartsWith("ranges has 2 beams, sensor 63 has 3 angles;"));
    sensor.angles = SteppedAngles{0.1, {1, 2, 4}};
    EXPECT_FALSE(check_scan(scan, sensor));
    scan.angles = ExplicitAngles{0.1, 0.2};
    EXPECT_TRUE(check_scan(scan, sensor)) << "the scan's own angles take precedence";
}

} // namespace
} // namespace scanloom::wire
