#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/server_process.hpp"

#include <functional>
#include <string>
#include <string_view>

/// What a server answers while something is wrong with its disk.
namespace scanloom::fault {

struct Readiness {
    unsigned status = 0;  ///< of /readyz: 200, or 503
    std::string answer{}; ///< JSON, with the reasons where it is not ready
};
[[nodiscard]] Readiness readiness(const ServerProcess& server);

/// Asks until /readyz has this status, doing something again and again.
/// @return the answer with that status; with another one after a minute, when it is never going to come.
Readiness wait_for_readiness(
    const ServerProcess& server, unsigned status, const std::function<void()>& doing = [] {});

/// That the maps of session "shared" are served all the same. `when` ends a sentence: "on a full disk".
void check_that_maps_are_served(const ServerProcess& server, std::string_view when, Outcome& outcome);

} // namespace scanloom::fault
