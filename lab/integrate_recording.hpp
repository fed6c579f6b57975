#pragma once

#include "lab/recording.hpp"

#include "core/mapping/projection.hpp"

#include <functional>

namespace scanloom::lab {

/// Returns seconds of a steady clock with any origin.
using Now = std::function<double()>;

/// Called after each scan with the number of scans integrated so far and their projection.
using AfterScan = std::function<void(std::size_t scans, mapping::Projection& projection)>;

/// Scans between two snapshots: a session whose robot sends ten scans per second publishes its maps at least once per
/// second.
inline constexpr std::size_t kScansPerSnapshot = 10;

/// Integrates a recording as a session would.
/// Errors: kInvalidField: a session would not accept these options.
/// @return seconds for each scan: to apply its entry and, after every kScansPerSnapshot scans, to make a snapshot,
///         which updates frontiers and danger; nothing else is included
[[nodiscard]] Result<std::vector<double>> integrate_recording(const Recording& recording, const SessionOptions& options,
                                                              const Now& now, const AfterScan& after_scan);

} // namespace scanloom::lab
