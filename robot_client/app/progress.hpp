#pragma once

#include "common/app/console.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// One line for people: how many scans are stored, how fast, how long it still takes.
/// `total` is the highest seq there will be, if that is known; `rate` scans a second; `remarks` those of the source.
[[nodiscard]] std::string progress_text(const UplinkStatus& status, std::optional<std::uint64_t> total, double rate,
                                        std::string_view remarks = {});

/// How far a log has been read before its first scan is sent.
[[nodiscard]] std::string reading_text(std::string_view file, const ReadProgress& progress);

/// Why nothing is sent for a while.
[[nodiscard]] std::string pause_text(std::chrono::duration<double> pause);

} // namespace scanloom::robot
