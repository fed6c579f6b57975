#pragma once

#include "load/core/figures.hpp"
#include "load/core/report.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// The state of a run at one moment. The use of processes counts from their start.
struct Moment {
    Micros at = 0;
    FleetFigures fleet;
    AudienceFigures audience;
    ProcessUse own;
    std::optional<ServerUse> server;
};

/// Describes what happened between two moments, in one line for a log.
/// @param begun  when the first scan was intended to be sent
[[nodiscard]] std::string live_line(const RunSettings& settings, Micros begun, const Moment& before, const Moment& now);

/// Describes what happened between two moments, as a table for a terminal.
[[nodiscard]] std::vector<std::string> live_table(const RunSettings& settings, Micros begun, const Moment& before,
                                                  const Moment& now);

} // namespace scanloom::load
