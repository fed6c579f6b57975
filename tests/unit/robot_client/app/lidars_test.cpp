#include "robot_client/app/lidars.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

TEST(LidarsText, NamesTheCommandOfEachLidar) {
    EXPECT_EQ(lidars_text({{"/dev/ttyUSB0", LidarIdentity{"rplidar-a1", "RPLIDAR A1, serial 1", 0}}}),
              "/dev/ttyUSB0: RPLIDAR A1, serial 1\n"
              "  scanloom-robot --server HOST:7447 --session NAME --robot NAME lidar rplidar-a1 /dev/ttyUSB0 --poses "
              "none\n");
    EXPECT_THAT(lidars_text({{"/dev/ttyS0", LidarIdentity{"hokuyo", "Hokuyo URG-04LX", 19'200}}}),
                HasSubstr("lidar hokuyo /dev/ttyS0 --poses none --baud 19200\n"));
}

TEST(LidarsText, SaysWhatIsMissing) {
    EXPECT_THAT(lidars_text({}), HasSubstr("no serial device of a USB adapter was found"));
    const std::string text = lidars_text({{"/dev/a", std::optional<LidarIdentity>{}},
                                          {"/dev/b", Error{Errc::kUnreachable, "/dev/b: cannot be opened"}}});
    EXPECT_THAT(text, HasSubstr("/dev/a: no known lidar answers; check that it has power"));
    EXPECT_THAT(text, HasSubstr("\n/dev/b: cannot be opened\n"));
}

} // namespace
} // namespace scanloom::robot
