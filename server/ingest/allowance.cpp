#include "server/ingest/allowance.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::ingest {

Allowance::Allowance(double now) : token_(access::anybody()), inflow_(token_->limits.bytes_per_second, 1.0, now) {}

void Allowance::set_token(access::TokenRef token, double now) {
    token_ = std::move(token);
    inflow_.set_rate(token_->limits.bytes_per_second, now);
}

Result<> Allowance::check(const wire::Message& message) {
    if (const auto* sensor = std::get_if<Sensor>(&message)) return check_sensor(*sensor);
    if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) return check_beams(*batch);
    return {};
}

Result<> Allowance::check_sensor(const Sensor& sensor) {
    sensors_.insert(sensor.id);
    const auto limit = token_->limits.sensors;
    if (sensors_.size() <= limit) return {};
    return Error{
        Errc::kTooLarge,
        fmt::format("sensor_description.sensor is {}, of another sensor than the {} that the limit `sensors` of "
                    "the token '{}' allows a robot; use these, or have the limit raised",
                    sensor.id, limit, token_->name)};
}

Result<> Allowance::check_beams(const wire::ScanBatch& batch) const {
    const auto limit = token_->limits.beams;
    for (std::size_t n = 0; n < batch.scans.size(); ++n) {
        const auto beams = batch.scans[n].ranges.size();
        if (beams <= limit) continue;
        return Error{
            Errc::kTooLarge,
            fmt::format("scan_batch.scans[{}].ranges has {} beams, the limit `beams` of the token '{}' allows {} "
                        "a scan; send fewer, or have the limit raised",
                        n, beams, token_->name, limit)};
    }
    return {};
}

std::size_t Allowance::read_max(std::size_t bytes) const noexcept {
    return static_cast<std::size_t>(std::min(inflow_.rate(), static_cast<double>(bytes)));
}

double Allowance::pause_after(std::size_t bytes, double now) noexcept {
    return inflow_.take(static_cast<double>(bytes), now);
}

} // namespace scanloom::ingest
