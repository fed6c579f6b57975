#include "robot_client/recordings/mcap.hpp"

#include "tests/fuzz/recording_check.hpp"

/// Input: a MCAP file.
SCANLOOM_FUZZER(mcap)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    fuzz::check_recording(robot::open_mcap, std::string_view(reinterpret_cast<const char*>(data), size));
    return 0;
}
