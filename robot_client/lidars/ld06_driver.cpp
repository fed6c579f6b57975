#include "robot_client/lidars/ld06_driver.hpp"

namespace scanloom::robot {

LidarStep Ld06Driver::on_open() {
    decoder_.restart();
    clock_.restart();
    turns_.restart();
    return {};
}

LidarStep Ld06Driver::on_bytes(std::span<const std::uint8_t> bytes, double arrival) {
    LidarStep step;
    decoder_.feed(bytes);
    while (const auto packet = decoder_.next()) {
        step.has_packet = true;
        turns_.add(*packet, clock_.stamp(packet->timestamp, arrival));
    }
    return step;
}

std::optional<Observation> Ld06Driver::next() {
    const auto turn = turns_.next();
    if (!turn) return std::nullopt;
    return Observation{sensor_, ld06_scan(*turn, options_)};
}

} // namespace scanloom::robot
