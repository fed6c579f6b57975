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
    std::optional<std::size_t> skipped_lines; ///< of logs and poses, if the source has any
    std::chrono::duration<double> elapsed{};
    std::optional<std::uint64_t> scan_count; ///< of the source, if it ends
    std::string remarks;                     ///< of the source
    std::string error;                       ///< why the run failed; empty if it did not
};

/// Returns one line of JSON, without its line break. Scans are counted as in the progress, from the first of the
/// recording or simulation: `scans` in total (of an endless source or a sensor: taken so far), `acknowledged` stored,
/// `stored_before` stored in earlier runs, `sent` in this run, `waiting` behind those in the spool, and `dropped` lost
/// for lack of room. `skipped_lines` and `order` are present if the source has them. A failed run has an `error`, one
/// sentence.
/// Pre: no text except the error needs escaping: valid names, a fingerprint.
[[nodiscard]] std::string summary_json(const Summary& summary);

} // namespace scanloom::robot
