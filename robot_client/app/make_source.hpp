#pragma once

#include "robot_client/app/options.hpp"
#include "robot_client/app/progress.hpp"
#include "robot_client/source/source.hpp"

#include <memory>

namespace scanloom::robot {

struct PreparedSource {
    std::unique_ptr<Source> source;
    std::size_t skipped_lines = 0;
    double speed = 0.0;
    std::string fingerprint; ///< for Hello.source
};

/// Reads the log or sets up the simulation. Lines of the log that cannot be used are told to the console, the first
/// few. Errors  those of CarmenLog::open().
[[nodiscard]] Result<PreparedSource> make_source(const RobotOptions& options, Console& console);

} // namespace scanloom::robot
