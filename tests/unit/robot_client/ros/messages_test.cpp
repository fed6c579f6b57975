#include "robot_client/ros/messages.hpp"
#include "robot_client/ros/ros_reader.hpp"
#include "tests/support/ros_bytes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::robot {
namespace {

using testing_support::RosWriter;
using testing_support::turned;

constexpr RosTime kStamp = 1'394'222'099'000'000'123;

RosLaserScan some_scan() {
    return {{kStamp, "laser"}, -1.5F, 1.5F, 0.75F, 0.001F, 0.1F, 0.1F, 30.0F, {1.0F, 2.0F, INFINITY, 0.0F, 3.5F}};
}

class RosMessages : public testing::TestWithParam<MessageEncoding> {};

TEST_P(RosMessages, LaserScanIsDecoded) {
    const RosLaserScan expected = some_scan();
    const auto bytes = testing_support::laser_bytes(expected, GetParam());
    const auto scan = decode_laser_scan(bytes, GetParam()).value();
    EXPECT_EQ(scan.header.stamp, kStamp);
    EXPECT_EQ(scan.header.frame, "laser");
    EXPECT_EQ(scan.angle_min, -1.5F);
    EXPECT_EQ(scan.angle_increment, 0.75F);
    EXPECT_EQ(scan.time_increment, 0.001F);
    EXPECT_EQ(scan.range_min, 0.1F);
    EXPECT_EQ(scan.range_max, 30.0F);
    EXPECT_EQ(scan.ranges, expected.ranges);
}

TEST_P(RosMessages, FirstEchoesOfAMultiEchoScanAreDecoded) {
    RosWriter writer(GetParam());
    writer.add_header(kStamp, "/laser");
    for (int n = 0; n < 7; ++n) writer.add(1.0F);
    writer.add(std::uint32_t{3}).add_floats({1.0F, 2.0F}).add_floats({}).add_floats({3.0F});
    writer.add(std::uint32_t{0});
    const auto scan = decode_laser_scan(writer.bytes(), GetParam(), kMultiEchoType).value();
    EXPECT_EQ(scan.header.frame, "laser") << "without the slash of early ROS 1";
    EXPECT_EQ(scan.ranges, (std::vector<float>{1.0F, INFINITY, 3.0F}));
}

TEST_P(RosMessages, OdometryIsDecoded) {
    auto expected = testing_support::flat(kStamp, "odom", "base_footprint", 1.5, -2.0, 0.7);
    const auto odometry = decode_odometry(testing_support::odometry_bytes(expected, GetParam()), GetParam()).value();
    EXPECT_EQ(odometry.header.frame, "odom");
    EXPECT_EQ(odometry.child, "base_footprint");
    EXPECT_TRUE(odometry.T_parent_child.isApprox(expected.T_parent_child, 1e-12));
}

TEST_P(RosMessages, TransformsThatArePossibleAreDecoded) {
    auto impossible = testing_support::flat(kStamp, "odom", "base", 1.0);
    impossible.T_parent_child.translation().x() = std::numeric_limits<double>::quiet_NaN();
    const auto good = testing_support::flat(kStamp, "/map", "/odom", 3.0, 4.0, -0.5);
    const auto itself = testing_support::flat(kStamp, "a", "a", 3.0);
    const auto bytes = testing_support::transform_bytes({impossible, good, itself}, GetParam());
    std::size_t left_out = 1;
    const auto transforms = decode_transforms(bytes, GetParam(), left_out).value();
    ASSERT_EQ(transforms.size(), 1U);
    EXPECT_EQ(transforms[0].header.frame, "map");
    EXPECT_EQ(transforms[0].child, "odom");
    EXPECT_TRUE(transforms[0].T_parent_child.isApprox(good.T_parent_child, 1e-12));
    EXPECT_EQ(left_out, 3U);
}

TEST_P(RosMessages, RotationsAreNormalisedAndNoRotationIsRefused) {
    const auto with = [&](double z, double w) {
        RosWriter writer(GetParam());
        writer.add_header(kStamp, "odom").add_text("base");
        for (const double each : {0.0, 0.0, 0.0, 0.0, 0.0, z, w}) writer.add(each);
        for (int n = 0; n < 36 + 6 + 36; ++n) writer.add(0.0);
        return decode_odometry(writer.bytes(), GetParam());
    };
    EXPECT_TRUE(with(3.0, 3.0).value().T_parent_child.linear().isApprox(turned(std::acos(0.0)).matrix(), 1e-12));
    EXPECT_EQ(with(0.0, 0.0).error().code, Errc::kInvalidField);
    EXPECT_EQ(with(NAN, 1.0).error().code, Errc::kInvalidField);
}

TEST_P(RosMessages, TruncatedOrLongerMessagesAreRefused) {
    const auto whole = testing_support::laser_bytes(some_scan(), GetParam());
    const auto odometry =
        testing_support::odometry_bytes(testing_support::flat(kStamp, "odom", "base", 1.0), GetParam());
    const auto transforms =
        testing_support::transform_bytes({testing_support::flat(kStamp, "odom", "base", 1.0)}, GetParam());
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_FALSE(decode_laser_scan(whole.substr(0, size), GetParam())) << size;
    }
    std::size_t left_out = 0;
    for (std::size_t size = 0; size < odometry.size(); ++size) {
        EXPECT_FALSE(decode_odometry(odometry.substr(0, size), GetParam())) << size;
    }
    for (std::size_t size = 0; size < transforms.size(); ++size) {
        EXPECT_FALSE(decode_transforms(transforms.substr(0, size), GetParam(), left_out)) << size;
    }
    EXPECT_EQ(decode_laser_scan(whole + std::string(8, '\0'), GetParam()).error().message,
              std::to_string(whole.size() + 8) + " bytes are no sensor_msgs/LaserScan");
}

INSTANTIATE_TEST_SUITE_P(Encodings, RosMessages, testing::Values(MessageEncoding::kRos1, MessageEncoding::kCdr),
                         [](const auto& encoding) {
                             return std::string(encoding.param == MessageEncoding::kCdr ? "Cdr" : "Ros1");
                         });

TEST(RosReader, BytesOfCdrMayBeSwapped) {
    RosWriter writer(MessageEncoding::kCdr, true);
    writer.add(std::uint8_t{1}).add(2.5).add_text("ab").add(std::uint16_t{0x1234});
    RosReader reader(writer.bytes(), MessageEncoding::kCdr);
    EXPECT_EQ(reader.number<std::uint8_t>(), 1);
    EXPECT_EQ(reader.number<double>(), 2.5);
    EXPECT_EQ(reader.text(), "ab");
    EXPECT_EQ(reader.number<std::uint16_t>(), 0x1234);
    EXPECT_TRUE(reader.is_complete());
}

TEST(RosReader, VersionTwoOfCdrAlignsToFourBytes) {
    const std::string bytes{'\0', '\7', '\0', '\0', '\1', 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0x40};
    RosReader reader(bytes, MessageEncoding::kCdr);
    EXPECT_EQ(reader.number<std::uint32_t>(), 1U);
    EXPECT_EQ(reader.number<double>(), 2.5);
    EXPECT_TRUE(reader.is_complete());
}

TEST(RosReader, OtherRepresentationsAndHugeCountsAreRefused) {
    for (const auto& bytes : {std::string("\0\2\0\0abcd", 8), std::string("\1\1\0\0abcd", 8), std::string("\0")}) {
        EXPECT_TRUE(RosReader(bytes, MessageEncoding::kCdr).failed());
    }
    RosReader reader("\xFF\xFF\xFF\xFFxxxx", MessageEncoding::kRos1);
    EXPECT_EQ(reader.count(4), 0U);
    EXPECT_TRUE(reader.failed());
    EXPECT_TRUE(RosReader("abcdefgh", MessageEncoding::kOther).failed());
}

} // namespace
} // namespace scanloom::robot
