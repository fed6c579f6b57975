#include "common/link/link_limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::link {

void LimitCheck::set_limits(LinkLimits limits, double now) {
    limits_ = std::move(limits);
    inflow_.set_rate(limits_.bytes_per_second, now);
}

Result<> LimitCheck::check(const wire::Message& message) {
    if (const auto* sensor = std::get_if<Sensor>(&message)) return check_sensor(*sensor);
    if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) return check_beams(*batch);
    return {};
}

Result<> LimitCheck::check_sensor(const Sensor& sensor) {
    sensors_.insert(sensor.id);
    if (sensors_.size() <= limits_.sensors) return {};
    return Error{
        Errc::kTooLarge,
        fmt::format("sensor_description.sensor is {}, of another sensor than the {} that the limit `sensors` of "
                    "the token '{}' allows a robot; use these, or raise the limit",
                    sensor.id, limits_.sensors, limits_.token)};
}

Result<> LimitCheck::check_beams(const wire::ScanBatch& batch) const {
    for (std::size_t n = 0; n < batch.scans.size(); ++n) {
        const auto beams = batch.scans[n].ranges.size();
        if (beams <= limits_.beams) continue;
        return Error{
            Errc::kTooLarge,
            fmt::format("scan_batch.scans[{}].ranges has {} beams, the limit `beams` of the token '{}' allows {} "
                        "a scan; send fewer, or raise the limit",
                        n, beams, limits_.token, limits_.beams)};
    }
    return {};
}

std::size_t LimitCheck::read_max(std::size_t bytes) const noexcept {
    return static_cast<std::size_t>(std::min(inflow_.rate(), static_cast<double>(bytes)));
}

double LimitCheck::pause_after(std::size_t bytes, double now) noexcept {
    return inflow_.take(static_cast<double>(bytes), now);
}

} // namespace scanloom::link
