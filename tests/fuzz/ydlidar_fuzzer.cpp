#include "tests/fuzz/lidar_check.hpp"

/// Input: see check_lidar().
SCANLOOM_FUZZER(ydlidar)(const std::uint8_t* data, std::size_t size) {
    scanloom::fuzz::check_lidar("ydlidar-x4", "ydlidar-x2", data, size);
    return 0;
}
