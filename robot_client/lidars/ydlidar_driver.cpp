#include "robot_client/lidars/ydlidar_driver.hpp"

#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::uint8_t kYdlidarStart = 0x60;
constexpr std::uint8_t kYdlidarStop = 0x65;
constexpr std::uint8_t kYdlidarInfo = 0x90;
constexpr std::uint8_t kYdlidarHealth = 0x92;

std::vector<A5Start> ydlidar_starts(const A5Identity&) {
    return {{a5_request(kYdlidarStart), {5, true, 0x81}}}; // packets have other sizes than 5
}

} // namespace

YdlidarDriver::YdlidarDriver(std::string title, bool is_started, std::shared_ptr<const Sensor> sensor,
                             const LidarScanOptions& options)
    : title_(std::move(title)), is_started_(is_started), sensor_(std::move(sensor)), options_(options),
      handshake_({title_, kYdlidarStop, kYdlidarInfo, kYdlidarHealth, ydlidar_starts}) {}

LidarStep YdlidarDriver::on_open() {
    decoder_.restart();
    turns_.restart();
    is_measuring_ = !is_started_;
    return is_started_ ? handshake_.begin() : LidarStep();
}

LidarStep YdlidarDriver::on_bytes(std::span<const std::uint8_t> bytes, double arrival) {
    if (is_measuring_) return {.has_packet = take_packets(bytes, arrival)};
    LidarStep step = handshake_.on_bytes(bytes);
    if (!handshake_.is_done()) return step;
    is_measuring_ = true;
    step.has_packet = take_packets(handshake_.rest(), arrival);
    return step;
}

/// @return whether there was a packet
bool YdlidarDriver::take_packets(std::span<const std::uint8_t> bytes, double arrival) {
    bool has_packet = false;
    decoder_.feed(bytes);
    while (const auto packet = decoder_.next()) {
        has_packet = true;
        if (packet->starts_turn) turns_.begin_turn(arrival);
        for (const auto& beam : packet->beams) turns_.add(beam);
    }
    return has_packet;
}

std::vector<std::uint8_t> YdlidarDriver::stop_request() const {
    return is_started_ ? a5_request(kYdlidarStop) : std::vector<std::uint8_t>();
}

std::optional<Observation> YdlidarDriver::next() {
    const auto turn = turns_.next();
    if (!turn) return std::nullopt;
    Observation taken{sensor_, lidar_scan(*turn, kYdlidarStepsPerTurn, options_)};
    taken.scan.intensities.clear();
    return taken;
}

LidarCounts YdlidarDriver::counts() const {
    return {
        .damaged = decoder_.damaged(), .turns = turns_.count(), .gaps = turns_.gaps(), .too_long = turns_.too_long()};
}

} // namespace scanloom::robot
