#pragma once

#include <string>
#include <string_view>

/// What every program of the project shares with its user.
namespace scanloom {

/// As CMake's project() has it; set by the build.
inline constexpr std::string_view kVersion = SCANLOOM_VERSION;

enum ExitCode : int {
    kExitDone = 0,
    kExitFailed = 1,
    kExitUsage = 2, ///< flags, environment or configuration file
};

/// Instead of running: how the program ends at once, and what it says.
struct Leave {
    ExitCode code = kExitDone;
    std::string text; ///< whole lines, for stdout when the code is kExitDone, or else for stderr
};

} // namespace scanloom
