#pragma once

#include "common/app/standard_streams.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Measures how fast a count has recently increased. An earlier outage or slow start does not affect the result.
class RecentRate {
public:
    static constexpr std::chrono::duration<double> kWindow{10.0};

    /// @param now    time since any fixed moment; must not decrease
    /// @param count  the current count
    /// @return increase per second over the window, or since the first call if that is shorter
    [[nodiscard]] double update(std::chrono::duration<double> now, std::uint64_t count);

private:
    struct Sample {
        std::chrono::duration<double> at;
        std::uint64_t count;
    };

    std::deque<Sample> samples_; ///< the first one is the newest that is at least as old as the window, or the oldest
};

/// Returns one line for people: how many scans are stored, the rate, and the remaining time.
/// @param total    the final highest seq, if known
/// @param rate     scans per second
/// @param remarks  of the source
[[nodiscard]] std::string progress_text(const UplinkStatus& status, std::optional<std::uint64_t> total, double rate,
                                        std::string_view remarks = {});

/// Returns how far a log has been read before its first scan is sent.
[[nodiscard]] std::string reading_text(std::string_view file, const ReadProgress& progress);

/// Returns why no scan is sent for some time.
[[nodiscard]] std::string pause_text(std::chrono::duration<double> pause);

/// What a recording or a live robot has that is not sent.
struct LeftOut {
    std::map<std::string, std::uint64_t> skipped; ///< scans, by the reason
    /// Of a file: damaged or missing bytes. Of a live robot: gaps in the stamps of its lasers, and frames that were
    /// refused.
    std::uint64_t lost_parts = 0;
};

struct Summary {
    std::string session;
    std::string robot;
    std::string source;     ///< Hello.source
    std::string_view order; ///< of a log's scans: "file" or "time"; else empty
    UplinkStatus status;
    std::optional<std::size_t> skipped_lines; ///< of logs and poses, if the source has any
    std::optional<LeftOut> left_out;          ///< of messages of ROS
    std::chrono::duration<double> elapsed{};
    std::optional<std::uint64_t> scan_count; ///< of the source, if it ends
    std::string_view localization;           ///< name of the newest state by the server; empty: it told none
    std::string remarks;                     ///< of the source
    std::string error;                       ///< why the run failed; empty if it did not
};

/// Returns one line of JSON, without its line break. Scans are counted as in the progress, from the first of the
/// recording or simulation: `scans` in total (of an endless source or a sensor: taken so far), `acknowledged` stored,
/// `stored_before` stored in earlier runs, `sent` in this run, `waiting` behind those in the spool, and `dropped` lost
/// for lack of room. `skipped_lines` and `order` are present if the source has them, `skipped` (scans by the reason)
/// and `lost_parts` if it has messages of ROS, and `localization` if the server estimates the robot's poses. A failed
/// run has an `error`, one sentence. Pre: no text except the error needs escaping: valid names, a fingerprint.
[[nodiscard]] std::string summary_json(const Summary& summary);

} // namespace scanloom::robot
