#include "tests/fuzz/lidar_check.hpp"

/// Input: see check_lidar().
SCANLOOM_FUZZER(hokuyo)(const std::uint8_t* data, std::size_t size) {
    scanloom::fuzz::check_lidar("hokuyo", "hokuyo", data, size);
    return 0;
}
