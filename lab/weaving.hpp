#pragma once

#include "lab/recording.hpp"

#include "server/mapping/projection.hpp"

#include <functional>

namespace scanloom::lab {

/// Seconds from any moment on, steady.
using Now = std::function<double()>;

/// Called after each scan: how many are woven, and the projection they are in.
using AfterScan = std::function<void(std::size_t scans, mapping::Projection& projection)>;

/// Scans between two snapshots: a session whose robot sends ten a second publishes its maps once a second at least.
inline constexpr std::size_t kScansPerSnapshot = 10;

/// Weaves a recording as a session would.
/// Errors  kInvalidField: settings no session takes.
/// @return the seconds that each scan took: to fold it, and after every kScansPerSnapshot scans to make a snapshot,
///         which brings frontiers and danger up to date; nothing else counted.
[[nodiscard]] Result<std::vector<double>> weave(const Recording& recording, const SessionOptions& options,
                                                const Now& now, const AfterScan& after_scan);

} // namespace scanloom::lab
