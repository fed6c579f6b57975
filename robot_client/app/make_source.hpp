#pragma once

#include "robot_client/app/options.hpp"
#include "robot_client/app/progress.hpp"
#include "robot_client/source/exploring_source.hpp"
#include "robot_client/source/live_source.hpp"
#include "robot_client/source/locating_source.hpp"
#include "robot_client/source/source.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct PreparedSource {
    std::unique_ptr<Source> source;           ///< a recording or simulation, or
    std::unique_ptr<LiveSource> live;         ///< what comes when it comes: exactly one of the two
    std::optional<std::size_t> skipped_lines; ///< of what was read as text
    double speed = 0.0;
    std::string fingerprint;              ///< for Hello.source
    std::string_view order;               ///< of a log's scans: "file" or "time", a literal; else empty
    ExploringSource* exploring = nullptr; ///< it is `live`, and has to be told whom to ask
    LocatingSource* locating = nullptr;   ///< likewise
    std::optional<wire::Near> near;       ///< of `locating`: where it stands first
    Point2 first_place{0.0, 0.0};         ///< of `locating`: where that is taken to be while nothing is mapped
    std::optional<double> body_radius;    ///< metres, of the robot whose scans they are, where it is known

    /// Those of the source.
    [[nodiscard]] std::string remarks() const { return live ? live->remarks() : source->remarks(); }
};

/// Reads the recording or sets up the simulation. Lines of the log that cannot be used are told to the console, the
/// first few, and whether its stamps go back. Errors  those of CarmenLog::open(), SonarLog::open(),
/// prepare_simulation() and prepare_ld06().
[[nodiscard]] Result<PreparedSource> make_source(const RobotOptions& options, Console& console);

} // namespace scanloom::robot
