#include "robot_client/lidars/rplidar_driver.hpp"

#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::uint8_t kStop = 0x25;
constexpr std::uint8_t kInfo = 0x50;
constexpr std::uint8_t kHealth = 0x52;
constexpr std::uint8_t kScan = 0x20;
constexpr std::uint8_t kExpressScan = 0x82;
constexpr std::uint8_t kMotorPwm = 0xF0;

constexpr A5Descriptor kNodes{kRplidarNodeBytes, true, 0x81};
constexpr A5Descriptor kCapsules{kRplidarCapsuleBytes, true, 0x82};

/// Returns the request that sets the speed of an A2's or A3's motor. Other sensors ignore it: the motor of an A1 is
/// switched by DTR, that of newer sensors turns while they measure.
std::vector<std::uint8_t> motor_request(std::uint16_t pwm) {
    return a5_request(kMotorPwm, {static_cast<std::uint8_t>(pwm & 0xFFU), static_cast<std::uint8_t>(pwm >> 8)});
}

std::vector<A5Start> starts_of(const A5Identity& identity) {
    constexpr std::uint16_t kUsualPwm = 660; // about ten turns per second
    constexpr int kSeriesBits = 4;           // the series is in the high bits of the model
    const int series = identity.model >> kSeriesBits;
    const bool has_motor_request = series == 2 || series == 3; // A2, A3
    const bool is_express = series <= 3 && std::pair(identity.firmware_major, identity.firmware_minor) >=
                                               std::pair<std::uint8_t, std::uint8_t>(1, 17);
    const auto request = [&](std::vector<std::uint8_t> start) {
        auto bytes = has_motor_request ? motor_request(kUsualPwm) : std::vector<std::uint8_t>();
        bytes.insert(bytes.end(), start.begin(), start.end());
        return bytes;
    };
    std::vector<A5Start> starts;
    if (is_express) starts.push_back({request(a5_request(kExpressScan, {0, 0, 0, 0, 0})), kCapsules});
    starts.push_back({request(a5_request(kScan)), kNodes});
    return starts;
}

} // namespace

RplidarDriver::RplidarDriver(std::string title, std::shared_ptr<const Sensor> sensor, const LidarScanOptions& options)
    : title_(std::move(title)), sensor_(std::move(sensor)), options_(options),
      handshake_({title_, kStop, kInfo, kHealth, starts_of}) {}

LidarStep RplidarDriver::on_open() {
    if (decoder_) damaged_before_ += decoder_->damaged();
    decoder_.reset();
    turns_.restart();
    return handshake_.begin();
}

LidarStep RplidarDriver::on_bytes(std::span<const std::uint8_t> bytes, double arrival) {
    if (decoder_) return {.has_packet = take_points(bytes, arrival)};
    LidarStep step = handshake_.on_bytes(bytes);
    if (!handshake_.is_done()) return step;
    has_quality_ = handshake_.packets() == kNodes;
    decoder_.emplace(!has_quality_);
    step.has_packet = take_points(handshake_.rest(), arrival);
    return step;
}

/// @return whether there was a point
bool RplidarDriver::take_points(std::span<const std::uint8_t> bytes, double arrival) {
    bool has_point = false;
    decoder_->feed(bytes);
    while (const auto point = decoder_->next()) {
        has_point = true;
        if (point->starts_turn) turns_.begin_turn(arrival);
        turns_.add({point->step, {static_cast<std::uint16_t>(point->distance / 4), point->quality}});
    }
    return has_point;
}

std::vector<std::uint8_t> RplidarDriver::stop_request() const {
    auto bytes = a5_request(kStop);
    const auto motor = motor_request(0);
    bytes.insert(bytes.end(), motor.begin(), motor.end());
    return bytes;
}

std::optional<Observation> RplidarDriver::next() {
    const auto turn = turns_.next();
    if (!turn) return std::nullopt;
    Observation taken{sensor_, lidar_scan(*turn, kRplidarStepsPerTurn, options_)};
    if (!has_quality_) taken.scan.intensities.clear();
    return taken;
}

LidarCounts RplidarDriver::counts() const {
    return {.damaged = damaged_before_ + (decoder_ ? decoder_->damaged() : 0),
            .turns = turns_.count(),
            .gaps = turns_.gaps(),
            .too_long = turns_.too_long()};
}

} // namespace scanloom::robot
