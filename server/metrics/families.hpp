#pragma once

#include <prometheus/metric_family.h>

#include <string>
#include <vector>

namespace scanloom::metrics {

/// A value that is read when it is asked for, rather than counted: one family of one metric.
[[nodiscard]] prometheus::MetricFamily gauge_now(std::string name, std::string help, double value);
[[nodiscard]] prometheus::MetricFamily counter_now(std::string name, std::string help, double value);

/// The text that Prometheus scrapes, format 0.0.4.
[[nodiscard]] std::string to_text(const std::vector<prometheus::MetricFamily>& families);

} // namespace scanloom::metrics
