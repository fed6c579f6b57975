#include "server/foxglove/log_recording.hpp"

#include "robot_client/ros/messages.hpp"
#include "tests/support/random_map.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::foxglove {
namespace {

using robot::MessageEncoding;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kStamp = 976052857.125;
constexpr std::int64_t kNanoseconds = 976052857'125'000'000;

Sensor laser() {
    Sensor sensor;
    sensor.angles = UniformAngles{-0.5, 0.25, 4};
    sensor.mount = {0.25, 0.0, std::numbers::pi / 2.0};
    sensor.range_min = 0.1;
    sensor.range_max = 12.0;
    return sensor;
}

Scan scan() {
    Scan taken;
    taken.seq = 1;
    taken.stamp = kStamp;
    taken.pose = {1.0, 2.0, 0.5};
    taken.ranges = {2005, kInvalidRange, kNoReturn, 99};
    return taken;
}

/// A recording of a robot's first entries.
LogRecording begun(ScanFilter filter = ScanFilter()) {
    LogRecording recording(std::move(filter));
    EXPECT_TRUE(recording.add(RobotJoined{0, "crawler"}));
    EXPECT_TRUE(recording.add(SensorDescribed{0, laser()}));
    return recording;
}

std::vector<robot::ReadMessage> messages_of(LogRecording& recording, const mapping::Snapshot& maps = {}) {
    recording.finish(maps);
    return robot::read_mcap(recording.take()).messages;
}

TEST(LogRecording, AScanHasATransformAndAPose) {
    auto recording = begun();
    EXPECT_TRUE(recording.add(ScanTaken{0, scan()}));
    const auto messages = messages_of(recording);
    ASSERT_EQ(messages.size(), 3U);

    EXPECT_EQ(messages[0].topic, "/tf");
    EXPECT_EQ(messages[0].time, kNanoseconds);
    std::size_t left_out = 0;
    const auto transforms = robot::decode_transforms(messages[0].bytes, MessageEncoding::kCdr, left_out).value();
    ASSERT_EQ(transforms.size(), 2U);
    EXPECT_EQ(transforms[0].header.frame, "map");
    EXPECT_EQ(transforms[0].header.stamp, kNanoseconds);
    EXPECT_EQ(transforms[0].child, "crawler/base_link");
    EXPECT_EQ(transforms[1].header.frame, "crawler/base_link");
    EXPECT_EQ(transforms[1].child, "crawler/sensor_0");
    const auto along = [](const auto& transform) { return (transform * Eigen::Vector3d::UnitX()).eval(); };
    EXPECT_TRUE(along(transforms[0].T_parent_child)
                    .isApprox(Eigen::Vector3d(1.0 + std::cos(0.5), 2.0 + std::sin(0.5), 0.0), 1e-12));
    EXPECT_TRUE(along(transforms[1].T_parent_child).isApprox(Eigen::Vector3d(0.25, 1.0, 0.0), 1e-12));

    EXPECT_EQ(messages[1].topic, "/crawler/pose");

    EXPECT_EQ(messages[2].topic, "/crawler/scan");
    const auto read = robot::decode_laser_scan(messages[2].bytes, MessageEncoding::kCdr).value();
    EXPECT_EQ(read.header.frame, "crawler/sensor_0");
    EXPECT_EQ(read.header.stamp, kNanoseconds);
    EXPECT_EQ(read.angle_min, -0.5F);
    EXPECT_EQ(read.angle_max, 0.25F);
    EXPECT_EQ(read.angle_increment, 0.25F);
    EXPECT_EQ(read.range_min, 0.1F);
    EXPECT_EQ(read.range_max, 12.0F);
    ASSERT_EQ(read.ranges.size(), 4U);
    EXPECT_EQ(read.ranges[0], 2.005F);
    EXPECT_TRUE(std::isnan(read.ranges[1]));
    EXPECT_EQ(read.ranges[2], std::numeric_limits<float>::infinity());
    EXPECT_TRUE(std::isnan(read.ranges[3])) << "nearer than range_min";
}

/// sensor_msgs/LaserScan has the stamp of the first beam, a Scan that of the middle. Transforms begin and end with the
/// beams.
TEST(LogRecording, BeamsHaveTheirTimes) {
    auto recording = begun();
    Scan taken = scan();
    taken.duration = -0.75;
    EXPECT_TRUE(recording.add(ScanTaken{0, taken}));
    const auto messages = messages_of(recording);
    ASSERT_EQ(messages.size(), 5U);
    const auto read = robot::decode_laser_scan(messages[3].bytes, MessageEncoding::kCdr).value();
    EXPECT_EQ(read.header.stamp, kNanoseconds + 375'000'000);
    EXPECT_EQ(read.time_increment, -0.25F);
    EXPECT_EQ(read.scan_time, 0.75F);
    for (const auto& [n, after] : {std::pair(0U, -375'000'000), std::pair(1U, 0), std::pair(4U, 375'000'000)}) {
        EXPECT_EQ(messages[n].topic, "/tf");
        EXPECT_EQ(messages[n].time, kNanoseconds + after);
    }
}

/// Each reading is at the nearest of twice as many evenly spaced beams.
TEST(LogRecording, UnevenBeamsAreMadeEven) {
    auto recording = begun();
    Scan taken = scan();
    taken.angles = ExplicitAngles{0.7, 0.0, 0.11, 0.3};
    taken.ranges = {2000, 3000, kNoReturn, kInvalidRange};
    taken.intensities = {5, 6, 7, 8};
    EXPECT_TRUE(recording.add(ScanTaken{0, taken}));
    const auto read = robot::decode_laser_scan(messages_of(recording)[2].bytes, MessageEncoding::kCdr).value();
    EXPECT_EQ(read.angle_min, 0.0F);
    EXPECT_FLOAT_EQ(read.angle_max, 0.7F);
    EXPECT_FLOAT_EQ(read.angle_increment, 0.1F);
    ASSERT_EQ(read.ranges.size(), 8U);
    EXPECT_EQ(read.ranges[0], 3.0F);
    EXPECT_EQ(read.ranges[1], std::numeric_limits<float>::infinity());
    for (const std::size_t n : {2U, 3U, 4U, 5U, 6U}) EXPECT_TRUE(std::isnan(read.ranges[n])) << n;
    EXPECT_EQ(read.ranges[7], 2.0F);
}

TEST(LogRecording, OtherSensorsHaveTheirOwnTopics) {
    auto recording = begun();
    Scan taken = scan();
    taken.sensor = 7;
    EXPECT_THAT(recording.add(ScanTaken{0, taken}).error().message, HasSubstr("sensor 7, which was not described"));
    Sensor other = laser();
    other.id = 7;
    EXPECT_TRUE(recording.add(SensorDescribed{0, other}));
    EXPECT_TRUE(recording.add(ScanTaken{0, taken}));
    EXPECT_EQ(messages_of(recording).at(2).topic, "/crawler/scan_7");
}

TEST(LogRecording, MoreTopicsThanAFileCanHaveAreRefused) {
    LogRecording recording{ScanFilter()};
    RobotIndex robot = 0;
    Result<> added;
    for (; added && robot < 40'000; ++robot) {
        EXPECT_TRUE(recording.add(RobotJoined{robot, fmt::format("r{}", robot)}));
        EXPECT_TRUE(recording.add(SensorDescribed{robot, laser()}));
        added = recording.add(ScanTaken{robot, scan()});
    }
    ASSERT_FALSE(added);
    EXPECT_EQ(added.error().code, Errc::kConflict);
    EXPECT_NEAR(robot, McapWriter::kChannelsMax / 2, 3) << "each robot has a pose and a scan";
}

TEST(LogRecording, ScansThatMapsLeaveOutHaveNoPlace) {
    auto recording = begun(ScanFilter(2.0));
    EXPECT_TRUE(recording.add(ScanTaken{0, scan()}));
    Scan stray = scan();
    stray.pose->x += 2.5;
    EXPECT_TRUE(recording.add(ScanTaken{0, stray}));
    Scan lost = scan();
    lost.pose.reset();
    EXPECT_TRUE(recording.add(ScanTaken{0, lost}));
    const auto messages = messages_of(recording);
    ASSERT_EQ(messages.size(), 5U);
    for (const std::size_t n : {3U, 4U}) {
        EXPECT_EQ(messages[n].topic, "/crawler/scan");
        EXPECT_EQ(robot::decode_laser_scan(messages[n].bytes, MessageEncoding::kCdr).value().header.frame,
                  "crawler/unplaced");
    }
}

/// Reads the bytes as OMG's CDR says, independently of the writer: positions are counted from the representation's end.
TEST(LogRecording, EndsWithTheMap) {
    testing_support::HandMadeMap map;
    map.set({-3, 2}, 2000);
    map.set({-1, 4}, -2000);
    auto recording = begun();
    EXPECT_TRUE(recording.add(ScanTaken{0, scan()}));
    const auto messages = messages_of(recording, map.snapshot());
    ASSERT_EQ(messages.size(), 4U);
    EXPECT_EQ(messages[3].topic, "/map");
    EXPECT_EQ(messages[3].time, kNanoseconds);
    const std::string& bytes = messages[3].bytes;
    const auto number = [&]<class Number>(std::size_t at, Number value) {
        std::memcpy(&value, bytes.data() + 4 + at, sizeof value);
        return value;
    };
    EXPECT_EQ(bytes.substr(0, 4), std::string("\0\1\0\0", 4));
    EXPECT_EQ(bytes.substr(16, 4), std::string("map\0", 4)); // after sec, nanosec and the length
    EXPECT_EQ(number(24, 0.0F), 0.05F) << "after map_load_time";
    EXPECT_EQ(number(28, 0U), 3U) << "width";
    EXPECT_EQ(number(32, 0U), 3U) << "height";
    EXPECT_NEAR(number(40, 0.0), -0.15, 1e-12);
    EXPECT_NEAR(number(48, 0.0), 0.1, 1e-12);
    EXPECT_EQ(number(88, 0.0), 1.0) << "w";
    EXPECT_EQ(number(96, 0U), 9U);
    std::vector<int> cells;
    for (const char cell : bytes.substr(4 + 100)) cells.push_back(cell);
    EXPECT_THAT(cells, ElementsAre(100, -1, -1, -1, -1, -1, -1, -1, 0));
}

TEST(LogRecording, ALogWithoutScansIsAFile) {
    auto recording = begun();
    EXPECT_THAT(messages_of(recording), IsEmpty());
}

} // namespace
} // namespace scanloom::foxglove
