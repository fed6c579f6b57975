#include "robot_client/ros/outgoing_messages.hpp"
#include "robot_client/ros/ros_reader.hpp"
#include "tests/support/ros_bytes.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

constexpr RosTime kGridStamp = 1'600'000'000'123'456'789;

class OutgoingMessages : public testing::TestWithParam<MessageEncoding> {};

TEST_P(OutgoingMessages, ATransformIsReadAsItWasWritten) {
    const auto bytes = encode_transform({kGridStamp, "map"}, "odom", {1.0, -2.0, 2.5}, GetParam());
    std::size_t left_out = 0;
    const auto read = decode_transforms(bytes, GetParam(), left_out);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 1U);
    EXPECT_EQ(left_out, 0U);
    const auto& one = read->front();
    EXPECT_EQ(one.header.stamp, kGridStamp);
    EXPECT_EQ(one.header.frame, "map");
    EXPECT_EQ(one.child, "odom");
    EXPECT_EQ(one.T_parent_child.translation(), Eigen::Vector3d(1.0, -2.0, 0.0));
    EXPECT_NEAR(std::atan2(one.T_parent_child(1, 0), one.T_parent_child(0, 0)), 2.5, 1e-12);
}

TEST_P(OutgoingMessages, AGridHasItsCellsByRows) {
    RosGrid grid{0.1, {-3.0, 4.0, 0.0}, 3, std::string("\x00\x64\xff\xff\x64\x00", 6)};
    EXPECT_EQ(grid.height(), 2U);
    const auto bytes = encode_grid({kGridStamp, "map"}, grid, GetParam());
    RosReader reader(bytes, GetParam());
    if (GetParam() == MessageEncoding::kRos1) {
        EXPECT_EQ(reader.number<std::uint32_t>(), 0U);
    }
    EXPECT_EQ(reader.number<std::uint32_t>(), 1'600'000'000U);
    EXPECT_EQ(reader.number<std::uint32_t>(), 123'456'789U);
    EXPECT_EQ(reader.text(), "map");
    EXPECT_EQ(reader.number<std::uint32_t>(), 1'600'000'000U);
    EXPECT_EQ(reader.number<std::uint32_t>(), 123'456'789U);
    EXPECT_EQ(reader.number<float>(), 0.1F);
    EXPECT_EQ(reader.number<std::uint32_t>(), 3U);
    EXPECT_EQ(reader.number<std::uint32_t>(), 2U);
    for (const double expected : {-3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0}) EXPECT_EQ(reader.number<double>(), expected);
    ASSERT_EQ(reader.count(1), 6U);
    for (const int expected : {0, 100, -1, -1, 100, 0}) EXPECT_EQ(reader.number<std::int8_t>(), expected);
    EXPECT_TRUE(reader.is_complete());
}

INSTANTIATE_TEST_SUITE_P(Encodings, OutgoingMessages, testing::Values(MessageEncoding::kRos1, MessageEncoding::kCdr));

TEST(OutgoingTypes, HaveMsgInRos2) {
    EXPECT_EQ(type_in("tf2_msgs/TFMessage", MessageEncoding::kRos1), "tf2_msgs/TFMessage");
    EXPECT_EQ(type_in("tf2_msgs/TFMessage", MessageEncoding::kCdr), "tf2_msgs/msg/TFMessage");
}

} // namespace
} // namespace scanloom::robot
