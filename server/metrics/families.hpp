#pragma once

#include <prometheus/metric_family.h>

#include <string>
#include <vector>

namespace scanloom::metrics {

/// Returns a family of one metric whose value is read at the time of the scrape instead of being counted.
[[nodiscard]] prometheus::MetricFamily gauge_now(std::string name, std::string help, double value);
[[nodiscard]] prometheus::MetricFamily counter_now(std::string name, std::string help, double value);

/// Returns the families in the Prometheus text format 0.0.4.
[[nodiscard]] std::string to_text(const std::vector<prometheus::MetricFamily>& families);

} // namespace scanloom::metrics
