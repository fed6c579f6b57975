#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace scanloom::fault {

/// How a server is started: a program, and words that come before the server's own options.
struct ServerCommand {
    std::filesystem::path program; ///< empty: the build's scanloom-server
    std::vector<std::string> words{};
};

} // namespace scanloom::fault
