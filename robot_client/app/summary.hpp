#pragma once

#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <string>

namespace scanloom::robot {

struct Summary {
    std::string session;
    std::string robot;
    UplinkStatus status;
    std::size_t skipped_lines = 0;
    std::chrono::duration<double> elapsed{};
    bool is_recording = false; ///< scans count from the beginning of the recording, else from that of this run
};

/// One line of JSON, without its line break. Pre: the names are valid ones.
[[nodiscard]] std::string summary_json(const Summary& summary);

} // namespace scanloom::robot
