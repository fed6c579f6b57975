#pragma once

#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct Summary {
    std::string session;
    std::string robot;
    std::string source;     ///< Hello.source
    std::string_view order; ///< of the scans: "file" or "time"
    UplinkStatus status;
    std::size_t skipped_lines = 0;
    std::chrono::duration<double> elapsed{};
};

/// One line of JSON, without its line break. Scans are counted as in the progress, from the first of the recording or
/// simulation: `stored_before` of them in earlier runs, `sent` in this one.
/// Pre  nothing in the texts needs escaping: valid names, a fingerprint.
[[nodiscard]] std::string summary_json(const Summary& summary);

} // namespace scanloom::robot
