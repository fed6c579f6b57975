#pragma once

#include "common/app/standard_streams.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

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

} // namespace scanloom::robot
