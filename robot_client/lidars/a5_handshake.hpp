#pragma once

#include "robot_client/lidars/a5_protocol.hpp"
#include "robot_client/lidars/lidar_driver.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A request that starts a measurement, and the descriptor that announces its packets.
struct A5Start {
    std::vector<std::uint8_t> request;
    A5Descriptor answer;
};

/// What differs between makers and models.
struct A5Dialect {
    std::string title; ///< with its article: "an RPLIDAR A1"
    std::uint8_t stop = 0;
    std::uint8_t info = 0;
    std::uint8_t health = 0;
    /// Returns the ways to start a sensor, the best first. Sensors that do not answer one are started by the next.
    std::function<std::vector<A5Start>(const A5Identity&)> starts;
};

/// The dialogue that starts a sensor: stops an earlier measurement, asks what the sensor is and how it is, and starts a
/// measurement. Each request without an answer is repeated.
class A5Handshake {
public:
    explicit A5Handshake(A5Dialect dialect) : dialect_(std::move(dialect)) {}

    /// Starts the dialogue.
    [[nodiscard]] LidarStep begin();

    /// @return the next step; if it is_done(), rest() has the bytes of the measurement
    [[nodiscard]] LidarStep on_bytes(std::span<const std::uint8_t> bytes);
    [[nodiscard]] LidarStep on_timeout();

    /// Returns whether the sensor measures.
    [[nodiscard]] bool is_done() const noexcept { return state_ == State::kDone; }

    /// Returns the descriptor of the packets. Pre: is_done().
    [[nodiscard]] const A5Descriptor& packets() const { return starts_.at(start_).answer; }

    /// Returns the bytes after that descriptor that have arrived until is_done().
    [[nodiscard]] std::span<const std::uint8_t> rest() const noexcept { return bytes_; }

private:
    enum class State { kStopping, kAskingInfo, kAskingHealth, kStarting, kDone };

    [[nodiscard]] A5Descriptor awaited() const;
    [[nodiscard]] LidarStep enter(State state);
    [[nodiscard]] LidarStep ask() const;
    [[nodiscard]] LidarStep take(std::span<const std::uint8_t> data);

    A5Dialect dialect_;
    State state_ = State::kStopping;
    int attempts_ = 0; ///< of the current request
    std::vector<std::uint8_t> bytes_;
    std::vector<A5Start> starts_;
    std::size_t start_ = 0; ///< the one that is tried
    std::string noted_;     ///< the newest note about the sensor
};

} // namespace scanloom::robot
