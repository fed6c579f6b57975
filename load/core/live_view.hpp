#pragma once

#include "load/core/audience_figures.hpp"
#include "load/core/fleet_figures.hpp"
#include "load/core/report.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// How things stand at one moment of a run. Processes: what they have used so far.
struct Moment {
    Micros at = 0;
    FleetFigures fleet;
    AudienceFigures audience;
    ProcessUse own;
    std::optional<ServerUse> server;
};

/// What happened between two moments, in one line for a log. `begun` is when the first scan was meant to be sent.
[[nodiscard]] std::string live_line(const RunSettings& settings, Micros begun, const Moment& before, const Moment& now);

/// The same as a table for a terminal.
[[nodiscard]] std::vector<std::string> live_table(const RunSettings& settings, Micros begun, const Moment& before,
                                                  const Moment& now);

} // namespace scanloom::load
