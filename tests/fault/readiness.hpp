#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/server_process.hpp"

#include <functional>
#include <string>
#include <string_view>

/// A server's answers while its disk fails.
namespace scanloom::fault {

struct Readiness {
    unsigned status = 0;  ///< of /readyz: 200, or 503
    std::string answer{}; ///< JSON, with the reasons if the server is not ready
};
[[nodiscard]] Readiness readiness(const ServerProcess& server);

/// Polls until /readyz has this status, and repeats an action meanwhile. @return the answer with that status; after a
/// minute without it, the last answer
Readiness wait_for_readiness(
    const ServerProcess& server, unsigned status, const std::function<void()>& doing = [] {});

/// Checks that the server still serves the maps of session "shared". `when` completes a sentence: "on a full disk".
void check_that_maps_are_served(const ServerProcess& server, std::string_view when, Outcome& outcome);

} // namespace scanloom::fault
