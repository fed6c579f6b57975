#include "robot_client/recordings/rosbag.hpp"

#include "tests/fuzz/recording_check.hpp"

/// Input: a ROS 1 bag.
SCANLOOM_FUZZER(rosbag)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    fuzz::check_recording(robot::open_rosbag, std::string_view(reinterpret_cast<const char*>(data), size));
    return 0;
}
