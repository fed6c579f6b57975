#include "tests/fuzz/lidar_check.hpp"

/// Input: see check_lidar().
SCANLOOM_FUZZER(rplidar)(const std::uint8_t* data, std::size_t size) {
    scanloom::fuzz::check_lidar("rplidar-a1", "rplidar-c1", data, size);
    return 0;
}
