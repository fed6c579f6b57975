#pragma once

#include <prometheus/metric_family.h>

#include <filesystem>
#include <vector>

namespace scanloom::metrics {

/// Returns the process_* metrics that Prometheus expects of every program: CPU seconds, resident and virtual bytes,
/// open and maximum file descriptors, start time. A value that the system does not report is left out.
/// Source: proc(5): self/stat, stat and self/fd below `proc`.
[[nodiscard]] std::vector<prometheus::MetricFamily> process_families(const std::filesystem::path& proc = "/proc");

} // namespace scanloom::metrics
