#include "common/wire/messages.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/frame_checksum.hpp"
#include "tests/unit/common/wire/example_messages.hpp"

#include "scanloom/v1/frame.pb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::wire {
namespace {

using testing::HasSubstr;

std::vector<Message> a_message_of_each_kind() {
    return {example_hello(),
            Welcome{"00000000000000ff", 13631, Limits{1U << 20, 4096, 1024}, 2U << 20, true},
            example_sensor(),
            example_batch(),
            Ack{17, 16, 1U << 21},
            LinkError{{Errc::kInvalidField, "scan_batch.scans[3].pose.x is nan"}, true},
            Ping{0xFEDCBA9876543210U},
            Pong{42},
            Goodbye{"every scan is acknowledged"},
            example_correction(),
            example_plan_request(),
            PlanReply{17, 99, example_path()},
            example_goal_request(),
            GoalReply{18, 99, example_goal()},
            example_coverage_request(),
            CoverageReply{19, 99, example_coverage()},
            CompressedScanBatch{5000, std::string("\x28\xb5\x2f\xfd\x00", 5)},
            example_locate_request(),
            LocateReply{20, 99, example_correction()}};
}

TEST(Messages, EveryKindIsDecodedUnchanged) {
    const auto messages = a_message_of_each_kind();
    ASSERT_EQ(messages.size(), std::variant_size_v<Message>);
    for (std::size_t kind = 0; kind < messages.size(); ++kind) {
        ASSERT_EQ(messages[kind].index(), kind);
        const auto decoded = decode(body_of(messages[kind]));
        ASSERT_TRUE(decoded) << name_of(messages[kind]) << ": " << decoded.error().message;
        EXPECT_EQ(*decoded, messages[kind]) << name_of(messages[kind]);
    }
}

TEST(Messages, NamesEqualTheFrameFields) {
    const auto* frame = v1::Frame::descriptor();
    for (const auto& message : a_message_of_each_kind()) {
        const auto* field = frame->FindFieldByName(std::string(name_of(message)));
        ASSERT_NE(field, nullptr) << name_of(message);
        v1::Frame proto;
        ASSERT_TRUE(proto.ParseFromString(body_of(message)));
        EXPECT_EQ(static_cast<int>(proto.body_case()), field->number());
    }
}

TEST(Messages, OptionalFieldsMayBeAbsent) {
    Hello hello = example_hello();
    hello.create.reset();
    hello.token.clear();
    hello.client.clear();
    hello.source.clear();
    hello.body_radius.reset();
    EXPECT_EQ(decode(body_of(hello)).value(), Message(hello));
    hello.create = SessionOptions{.p_min = 0.0};
    EXPECT_EQ(decode(body_of(hello)).value(), Message(hello)) << "an option of 0 must not become absent";

    for (const Message& request : {Message(PlanRequest{.id = 1, .goal = {0.0, 0.0}}), Message(GoalRequest{}),
                                   Message(CoverageRequest{.id = 3})}) {
        EXPECT_EQ(decode(body_of(request)).value(), request);
    }
    const Message point =
        PlanRequest{.start = Point2{0.0, 0.0}, .goal = {0.0, 0.0}, .body_radius = 0.0, .danger_cost = 0.0};
    EXPECT_EQ(decode(body_of(point)).value(), point) << "a value of 0 must not become absent";

    Scan scan = example_scan();
    scan.pose.reset();
    EXPECT_EQ(decode(body_of(ScanBatch{{scan}})).value(), Message(ScanBatch{{scan}}));
    scan.odometry.reset();
    scan.intensities.clear();
    scan.angles.reset();
    EXPECT_EQ(decode(body_of(ScanBatch{{scan}})).value(), Message(ScanBatch{{scan}}));
    scan.begins_map = true;
    EXPECT_EQ(decode(body_of(ScanBatch{{scan}})).value(), Message(ScanBatch{{scan}}));
    Sensor sensor = example_sensor();
    sensor.angles = ExplicitAngles{3.0, -1.0};
    EXPECT_EQ(decode(body_of(sensor)).value(), Message(sensor));
    sensor.angles = SteppedAngles{-1e-9, {0, INT32_MAX, 1, -INT32_MAX, 0, -1}};
    EXPECT_EQ(decode(body_of(sensor)).value(), Message(sensor));
}

TEST(Messages, PosesOfHelloAreDecodedUnchanged) {
    Hello hello = example_hello();
    for (const auto poses : {Poses::kMap, Poses::kOdometry, Poses::kNone}) {
        hello.poses = poses;
        EXPECT_EQ(decode(body_of(hello)).value(), Message(hello)) << name_of(poses);
    }
}

TEST(Messages, SteppedAnglesTakeTwoBytesPerBeam) {
    Scan scan = example_scan();
    scan.intensities.clear();
    scan.ranges.assign(450, 1000);
    scan.angles = UniformAngles{0.5, 0.01, 450};
    const std::size_t without = body_of(ScanBatch{{scan}}).size();
    SteppedAngles stepped{0.01 / 11.0 * std::numbers::pi / 180.0, {}};
    for (std::int32_t beam = 0; beam < 450; ++beam) stepped.steps.push_back(871 * beam + beam % 7);
    scan.angles = stepped;
    EXPECT_EQ(decode(body_of(ScanBatch{{scan}})).value(), Message(ScanBatch{{scan}}));
    EXPECT_LE(body_of(ScanBatch{{scan}}).size(), without + 2 * 450);
}

TEST(Messages, ErrorCodesAreDecodedUnchanged) {
    for (const Errc code : {Errc::kMalformed, Errc::kTooLarge, Errc::kUnsupportedVersion, Errc::kInvalidField,
                            Errc::kNotFound, Errc::kConflict, Errc::kOutOfOrder, Errc::kCreditExceeded, Errc::kTimeout,
                            Errc::kReplaced, Errc::kGone, Errc::kStoreFailed, Errc::kShuttingDown, Errc::kUnauthorized,
                            Errc::kOverloaded, Errc::kInternal, Errc::kFull, Errc::kNoPath}) {
        for (const Message& message :
             {Message(LinkError{{code, "why"}, false}), Message(PlanReply{1, 2, Error{code, "why"}}),
              Message(GoalReply{1, 2, Error{code, "why"}}), Message(CoverageReply{1, 2, Error{code, "why"}})}) {
            EXPECT_EQ(decode(body_of(message)).value(), message) << name_of(code);
        }
    }
}

TEST(Messages, DecodingNormalisesYaw) {
    Scan scan = example_scan();
    scan.pose->yaw = 7.0;
    const auto decoded = decode(body_of(ScanBatch{{scan}})).value();
    EXPECT_DOUBLE_EQ(std::get<ScanBatch>(decoded).scans[0].pose->yaw, 7.0 - 2.0 * std::numbers::pi);
}

TEST(Messages, LargestScanAndLargestBatchAreAccepted) {
    Scan scan = example_scan();
    scan.ranges.assign(kBeamsMax, 1000);
    scan.intensities.assign(kBeamsMax, 7);
    scan.angles = UniformAngles{0.0, 2.0 * std::numbers::pi / 4095.0, kBeamsMax};
    EXPECT_TRUE(decode(body_of(ScanBatch{{scan}}))) << "the last beam may repeat the first direction";
    EXPECT_TRUE(decode(body_of(ScanBatch{std::vector<Scan>(kScansPerBatchMax, example_scan())})));
}

TEST(Messages, LongestPathFitsInAFrame) {
    const Path path{std::vector<Point2>(kReplyPointsMax, Point2{-1e5 / 3.0, 1e6 / 3.0}), 1e9 / 3.0, 1e10 / 3.0};
    const Path short_path{{Point2{1.0, 2.0}}, 0.0, 0.0};
    const std::vector<CellRun> runs(kReplyPointsMax - 1, {INT32_MIN, INT32_MAX, INT32_MAX});
    for (const Message& reply :
         {Message(PlanReply{UINT64_MAX, UINT64_MAX, path}),
          Message(GoalReply{UINT64_MAX, UINT64_MAX, Goal{Exploration::kGoal, path, Point2{0.1, 0.2}}}),
          Message(CoverageReply{UINT64_MAX, UINT64_MAX, Coverage{path, 0.1, 0.2}}),
          Message(CoverageReply{UINT64_MAX, UINT64_MAX, Coverage{short_path, 0.1, 0.2, runs, 0.05}})}) {
        EXPECT_LE(body_of(reply).size(), kFrameBytesMax);
        EXPECT_EQ(decode(body_of(reply)).value(), reply);
    }
}

TEST(Messages, GoalMayBeAbsent) {
    for (const auto none : {Exploration::kTakenByOthers, Exploration::kComplete}) {
        const Message reply = GoalReply{1, 2, Goal{none, std::nullopt, std::nullopt}};
        EXPECT_EQ(decode(body_of(reply)).value(), reply);
    }
}

TEST(Messages, FrameWithoutBodyIsMalformed) {
    const std::string unknown_field = "\xfa\x01\x02hi"; // field 31, as a newer version may have
    for (const std::string& body : {std::string(), unknown_field}) {
        const auto decoded = decode(body);
        ASSERT_FALSE(decoded);
        EXPECT_EQ(decoded.error().code, Errc::kMalformed);
        EXPECT_THAT(decoded.error().message, HasSubstr("a frame without a body"));
    }
}

TEST(Messages, UnknownFieldsAreSkipped) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(Ping{5})));
    const std::string body = frame.SerializeAsString() + "\xfa\x01\x02hi";
    EXPECT_EQ(decode(body).value(), Message(Ping{5}));
}

/// Expects that decode() returns a validated message or an error with a message, for arbitrary bytes.
void expect_decoded_or_refused(std::string_view body) {
    const auto decoded = decode(body);
    if (!decoded) {
        EXPECT_FALSE(decoded.error().message.empty());
        return;
    }
    const auto* batch = std::get_if<ScanBatch>(&*decoded);
    if (batch == nullptr) return;
    for (const auto& scan : batch->scans) {
        EXPECT_TRUE((!scan.pose || is_finite(*scan.pose)) && std::isfinite(scan.stamp));
        EXPECT_TRUE(!scan.ranges.empty() && scan.ranges.size() <= kBeamsMax);
        EXPECT_TRUE(scan.intensities.empty() || scan.intensities.size() == scan.ranges.size());
    }
}

TEST(Messages, TruncatedFramesAreDecodedOrRefused) {
    for (const auto& message : a_message_of_each_kind()) {
        const std::string body = body_of(message);
        for (std::size_t bytes = 0; bytes < body.size(); ++bytes) {
            SCOPED_TRACE(std::string(name_of(message)) + " cut to " + std::to_string(bytes));
            const auto decoded = decode(std::string_view(body).substr(0, bytes));
            const bool is_complete = bytes == body.size() - kChecksumBytes; // only the checksum is missing
            EXPECT_EQ(decoded.has_value(), is_complete) << "the frame's only field is truncated";
        }
    }
}

TEST(Messages, FlippedBitsAreDecodedOrRefused) {
    for (const auto& message : a_message_of_each_kind()) {
        const std::string body = body_of(message);
        for (std::size_t bit = 0; bit < body.size() * 8; ++bit) {
            std::string flipped = body;
            flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
            expect_decoded_or_refused(flipped);
        }
    }
}

TEST(Messages, RandomBytesAreDecodedOrRefused) {
    std::mt19937 random(3);
    for (int round = 0; round < 20'000; ++round) {
        std::string body(random() % 200, '\0');
        for (char& byte : body) byte = static_cast<char>(random());
        expect_decoded_or_refused(body);
    }
}

TEST(Messages, DeeplyNestedGroupsAreRefused) {
    const auto decoded = decode(std::string(100'000, '\x0b')); // start of group 1, repeated
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, Errc::kMalformed);
}

} // namespace
} // namespace scanloom::wire
