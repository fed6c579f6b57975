#include "load/core/fleet_figures.hpp"

#include <algorithm>

namespace scanloom::load {

void FleetFigures::add(const FleetFigures& other) noexcept {
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
    from_intended.add(other.from_intended);
    from_sending.add(other.from_sending);
    waiting_to_send.add(other.waiting_to_send);
    own_delay.add(other.own_delay);
}

} // namespace scanloom::load
