#include "load/core/figures.hpp"

#include <algorithm>

namespace scanloom::load {

void FleetCounts::add(const FleetCounts& other) noexcept {
    scans_due += other.scans_due;
    scans_sent += other.scans_sent;
    scans_resent += other.scans_resent;
    scans_acknowledged += other.scans_acknowledged;
    scans_lost += other.scans_lost;
    frames_out += other.frames_out;
    bytes_out += other.bytes_out;
    bytes_in += other.bytes_in;
    linked += other.linked;
    greeted += other.greeted;
    finished += other.finished;
    failed += other.failed;
    links += other.links;
    for (std::size_t i = 0; i < kFaultKinds; ++i) faults[i] += other.faults[i];
    last_ack = std::max(last_ack, other.last_ack);
}

void FleetFigures::add(const FleetFigures& other) noexcept {
    FleetCounts::add(other);
    from_intended.add(other.from_intended);
    from_sending.add(other.from_sending);
    waiting_to_send.add(other.waiting_to_send);
    own_delay.add(other.own_delay);
}

std::optional<ServerUsed> used_between(const std::optional<ServerUse>& before, const std::optional<ServerUse>& after) {
    if (!before || !after) return std::nullopt;
    ServerUsed used{std::nullopt, after->so_far.resident_bytes};
    const double cpu_seconds = after->so_far.cpu_seconds - before->so_far.cpu_seconds;
    const bool is_same_process = before->started == after->started && cpu_seconds >= 0.0;
    if (is_same_process) used.cpu_seconds = cpu_seconds;
    return used;
}

} // namespace scanloom::load
