#pragma once

#include "lab/recording.hpp"
#include "lab/scoring.hpp"

#include "server/mapping/projection.hpp"

#include <functional>

namespace scanloom::lab {

/// Seconds from any moment on, steady.
using Now = std::function<double()>;

/// Called after each scan: how many are woven, and the projection they are in.
using AfterScan = std::function<void(std::size_t scans, mapping::Projection& projection)>;

/// Weaves a recording as a session would.
/// Errors  kInvalidField: settings no session takes.
/// @return the seconds that folding each scan took, nothing else counted.
[[nodiscard]] Result<std::vector<double>> weave(const Recording& recording, const SessionOptions& options,
                                                const Now& now, const AfterScan& after_scan);

/// The map as the classes of the defaults: occupied from p 0.65, free up to p 0.35.
struct MapStates {
    StateGrid states;
    std::size_t touched = 0; ///< cells of the whole map that any scan changed
};

[[nodiscard]] MapStates states_of(const mapping::Snapshot& snapshot, const grid::CellBox& box);

} // namespace scanloom::lab
