#pragma once

#include "server/store/scan_log.hpp"
#include "tests/fault/row.hpp"

#include <functional>
#include <memory>

namespace scanloom::fault {

/// What the links of a run go to.
struct LinkTrial {
    std::function<std::unique_ptr<store::ScanLog>()> make_log; ///< the server's
    bool forges = false;                                       ///< SpoiledStream's
};

/// A robot's first links are spoiled, each direction in one way, and the following ones are not: the stream completes,
/// or ends with a sentence that says why; the server holds what it should either way. Counts robots, each of a seed of
/// its own.
[[nodiscard]] Outcome run_link_row(const Run& run);
[[nodiscard]] Outcome run_link_row(const Run& run, const LinkTrial& trial);

} // namespace scanloom::fault
