#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace scanloom::fault {

/// How a server or a robot is started: a program, and words that come before its own options.
struct Command {
    std::filesystem::path program; ///< empty: the build's scanloom-server, or scanloom-robot
    std::vector<std::string> words{};
};

} // namespace scanloom::fault
