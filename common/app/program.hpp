#pragma once

#include <string>
#include <string_view>

/// What all programs of the project have in common for their users.
namespace scanloom {

/// The version in CMake's project(); the build defines it.
inline constexpr std::string_view kVersion = SCANLOOM_VERSION;

enum ExitCode : int {
    kExitDone = 0,
    kExitFailed = 1,
    kExitUsage = 2, ///< wrong flags, environment or configuration file
};

/// How a program ends instead of running: exit code and output.
struct Leave {
    ExitCode code = kExitDone;
    std::string text; ///< whole lines, for stdout if the code is kExitDone, else for stderr
};

} // namespace scanloom
