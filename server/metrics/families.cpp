#include "server/metrics/families.hpp"

#include <prometheus/text_serializer.h>

#include <utility>

namespace scanloom::metrics {

prometheus::MetricFamily gauge_now(std::string name, std::string help, double value) {
    prometheus::ClientMetric metric;
    metric.gauge.value = value;
    return {std::move(name), std::move(help), prometheus::MetricType::Gauge, {metric}};
}

prometheus::MetricFamily counter_now(std::string name, std::string help, double value) {
    prometheus::ClientMetric metric;
    metric.counter.value = value;
    return {std::move(name), std::move(help), prometheus::MetricType::Counter, {metric}};
}

std::string to_text(const std::vector<prometheus::MetricFamily>& families) {
    return prometheus::TextSerializer().Serialize(families);
}

} // namespace scanloom::metrics
