#pragma once

#include "server/store/scan_log.hpp"
#include "tests/fault/row.hpp"

#include <functional>
#include <memory>

namespace scanloom::fault {

/// The server end of the links of a run.
struct LinkTrial {
    std::function<std::unique_ptr<store::ScanLog>()> make_log; ///< creates the server's log
    bool forges = false;                                       ///< see SpoiledStream
};

/// Row "link": spoils a robot's first connections, each direction in one way, but not the later ones. The stream
/// completes or ends with an error message that gives the reason; in both cases the server holds the expected scans.
/// Counts robots, each with its own seed.
[[nodiscard]] Outcome run_link_row(const Run& run);
[[nodiscard]] Outcome run_link_row(const Run& run, const LinkTrial& trial);

} // namespace scanloom::fault
