#include "common/wire/log_codec.hpp"

#include "tests/unit/common/wire/example_messages.hpp"

#include "scanloom/v1/log.pb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace scanloom::wire {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::vector<LogEntry> one_of_each() {
    Scan stepped = example_scan(18);
    stepped.angles = SteppedAngles{1.5e-5, {395'000, 12, -7}};
    Scan unplaced = example_scan(19);
    unplaced.pose.reset();
    return {RobotJoined{3, "robot-1"},
            RobotJoined{3, "robot-1", "carmen:12", 0.25},
            RobotJoined{3, "robot-1", "", std::nullopt, Poses::kOdometry},
            RobotJoined{3, "robot-1", "", std::nullopt, Poses::kNone},
            SensorDescribed{3, example_sensor()},
            ScanTaken{3, example_scan(17)},
            ScanTaken{3, stepped},
            ScanTaken{3, unplaced},
            ScanTaken{3, example_scan(20), true},
            ScansExcluded{2, 3, StampRange{-1.5, 1e9}},
            ScansExcluded{3, 1, SeqRange{4, 4}},
            ExclusionLifted{2},
            MapsCorrected{300},
            RobotRelocalized{2, {1.5, -2.5}, 10.0},
            ModeChanged{true},
            ModeChanged{false}};
}

TEST(LogCodec, DecodingReturnsEveryKindOfEntry) {
    for (const auto& entry : one_of_each()) {
        const auto decoded = decode_entry(encode_entry(entry));
        ASSERT_TRUE(decoded) << decoded.error().message;
        EXPECT_EQ(*decoded, entry);
    }
}

TEST(LogCodec, ScanPoseIsDecodedWithoutTheScan) {
    for (const auto& entry : one_of_each()) {
        for (const auto& bytes : {encode_entry(entry), plain_entry(encode_entry(entry)).value()}) {
            const auto where = decode_scan_pose(bytes).value();
            const auto* taken = std::get_if<ScanTaken>(&entry);
            ASSERT_EQ(where.has_value(), taken != nullptr);
            if (taken == nullptr) continue;
            EXPECT_EQ(*where, scan_pose_of(*taken));
        }
    }
    EXPECT_FALSE(decode_scan_pose("\xff"));
    auto nowhere = example_scan(1);
    nowhere.pose->x = HUGE_VAL;
    EXPECT_THAT(decode_scan_pose(encode_entry(ScanTaken{0, nowhere})).error().message, HasSubstr("scan_taken.pose"));
}

TEST(LogCodec, EntryOfTheFirstFormatIsDecoded) {
    // seq 7, pose (1, 0, 0), ranges 1500 and 0 as fixed32, byte by byte as stored on disk.
    const std::string pose("\x22\x09\x09\0\0\0\0\0\0\xf0\x3f", 11);
    const std::string ranges("\x32\x08\xdc\x05\0\0\0\0\0\0", 10);
    const std::string scan = std::string("\x08\x07", 2) + pose + ranges;
    const std::string bytes = std::string("\x1a\x1b\x08\x03\x12\x17", 6) + scan;
    Scan expected;
    expected.seq = 7;
    expected.pose = Pose2{1.0, 0.0, 0.0};
    expected.ranges = {1500, 0};
    const LogEntry entry = ScanTaken{3, expected};
    EXPECT_EQ(decode_entry(bytes).value(), entry);
    EXPECT_EQ(plain_entry(bytes).value(), bytes);
}

TEST(LogCodec, PlainEntryDecodesEqually) {
    for (const auto& entry : one_of_each()) {
        const auto plain = plain_entry(encode_entry(entry)).value();
        EXPECT_EQ(decode_entry(plain).value(), entry);
        EXPECT_EQ(plain_entry(plain).value(), plain);
        if (!std::holds_alternative<ScanTaken>(entry)) continue;
        EXPECT_NE(plain, encode_entry(entry)) << "the two encodings must differ";
        const auto packed = encode_entry(entry);
        EXPECT_FALSE(decode_entry(packed + plain)) << "ranges twice over"; // protobuf merges repeated messages
    }
    EXPECT_FALSE(plain_entry("\xff"));
}

TEST(LogCodec, InvalidBodyRadiusIsDamage) {
    for (const double radius : {0.0, -1.0, 5.5, std::nan("")}) {
        const auto decoded = decode_entry(encode_entry(RobotJoined{0, "r", "", radius}));
        ASSERT_FALSE(decoded) << radius;
        EXPECT_THAT(decoded.error().message, StartsWith("a log entry in the store cannot be read"));
    }
}

TEST(LogCodec, UnknownPosesAreDamage) {
    v1::LogEntry entry;
    entry.mutable_robot_joined()->set_name("r");
    ASSERT_TRUE(decode_entry(entry.SerializeAsString()));
    entry.mutable_robot_joined()->set_poses(static_cast<v1::Poses>(3));
    const auto decoded = decode_entry(entry.SerializeAsString());
    ASSERT_FALSE(decoded);
    EXPECT_THAT(decoded.error().message, StartsWith("a log entry in the store cannot be read"));
}

TEST(LogCodec, DecodedWireScanSurvivesTheLog) {
    Scan scan = example_scan();
    scan.pose->yaw = -9.0;
    const auto batch = std::get<ScanBatch>(decode(body_of(ScanBatch{{scan}})).value());
    const LogEntry entry = ScanTaken{0, batch.scans[0]};
    EXPECT_EQ(decode_entry(encode_entry(entry)).value(), entry) << "normalising a pose twice has no effect";
}

TEST(LogCodec, EveryTruncatedEntryIsRefused) {
    for (const auto& entry : one_of_each()) {
        const std::string bytes = encode_entry(entry);
        for (std::size_t kept = 0; kept < bytes.size(); ++kept) {
            const auto decoded = decode_entry(std::string_view(bytes).substr(0, kept));
            ASSERT_FALSE(decoded) << kept << " of " << bytes.size();
            EXPECT_EQ(decoded.error().code, Errc::kMalformed);
            EXPECT_THAT(decoded.error().message, StartsWith("a log entry in the store cannot be read"));
        }
    }
}

TEST(LogCodec, DamagedBytesAreDecodedOrRefused) {
    std::mt19937 random(5);
    for (const auto& entry : one_of_each()) {
        const std::string bytes = encode_entry(entry);
        for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
            std::string flipped = bytes;
            flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
            const auto decoded = decode_entry(flipped);
            EXPECT_TRUE(decoded || !decoded.error().message.empty());
        }
    }
    for (int round = 0; round < 20'000; ++round) {
        std::string bytes(random() % 100, '\0');
        for (char& byte : bytes) byte = static_cast<char>(random());
        const auto decoded = decode_entry(bytes);
        EXPECT_TRUE(decoded || !decoded.error().message.empty());
    }
}

TEST(LogCodec, InvalidValuesAreRefusedByName) {
    Scan scan = example_scan();
    scan.pose->x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(decode_entry(encode_entry(ScanTaken{0, scan})).error().message, StartsWith("scan_taken.pose.x is nan"));
    Sensor sensor = example_sensor();
    sensor.range_max = -1.0;
    EXPECT_THAT(decode_entry(encode_entry(SensorDescribed{0, sensor})).error().message,
                StartsWith("sensor_described.range_max is -1"));
}

TEST(LogCodec, DecodingReturnsTheSession) {
    const SessionRecord record{"Intel_Lab", 1.75e9, {.cell_size = 0.1, .p_prior = 0.4}, 3, "depot", 17};
    const auto decoded = decode_session(encode_session(record));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(*decoded, record);
}

TEST(LogCodec, SessionFromBeforeTokensHasNoCreator) {
    const auto decoded = decode_session("\n\3lab"); // only its name, field 1
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->name, "lab");
    EXPECT_EQ(decoded->created_by, "");
    EXPECT_EQ(decoded->chunks_max, 0U);
}

TEST(LogCodec, InvalidNameIsDamage) {
    for (const auto* name : {"", "../../tmp/other", "a/b", "a b", "a\nfake line", "\xff"}) {
        SessionRecord record;
        record.name = name;
        EXPECT_EQ(decode_session(encode_session(record)).error().code, Errc::kMalformed) << name;
        EXPECT_EQ(decode_entry(encode_entry(RobotJoined{0, name})).error().code, Errc::kMalformed) << name;
    }
}

TEST(LogCodec, DamagedSessionIsRefused) {
    std::string bytes = encode_session({"Intel_Lab", 1.75e9, {.cell_size = 0.1}});
    bytes.pop_back();
    const auto decoded = decode_session(bytes);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, Errc::kMalformed);
    EXPECT_THAT(decoded.error().message, HasSubstr("a session in the store cannot be read"));
}

} // namespace
} // namespace scanloom::wire
