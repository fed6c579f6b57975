#pragma once

#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct Summary {
    std::string session;
    std::string robot;
    std::string source;     ///< Hello.source
    std::string_view order; ///< of a log's scans: "file" or "time"; else empty
    UplinkStatus status;
    std::optional<std::size_t> skipped_lines; ///< of logs and poses, where there are some
    std::chrono::duration<double> elapsed{};
    std::optional<std::uint64_t> scan_count; ///< of the source, where it has an end
    std::string remarks;                     ///< of the source
    std::string error;                       ///< why it failed; empty: it did not
};

/// One line of JSON, without its line break. Scans are counted as in the progress, from the first of the recording or
/// simulation: `scans` there are (of an endless one, or a sensor: were taken so far), `acknowledged` of them are
/// stored, `stored_before` from earlier runs, and `sent` in this one; `waiting` are in the spool behind those,
/// `dropped` were lost for want of room. `skipped_lines` and `order` are there where a source has them. A run that
/// failed has an `error`, one sentence.
/// Pre  nothing in the texts but the error needs escaping: valid names, a fingerprint.
[[nodiscard]] std::string summary_json(const Summary& summary);

} // namespace scanloom::robot
