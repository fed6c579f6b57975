#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace scanloom::fault {

/// The command that starts a server or a robot: a program, and arguments that precede its own options.
struct Command {
    std::filesystem::path program; ///< empty: scanloom-server or scanloom-robot of the build
    std::vector<std::string> words{};
};

} // namespace scanloom::fault
