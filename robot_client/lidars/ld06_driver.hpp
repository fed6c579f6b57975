#pragma once

#include "robot_client/lidars/ld06_packet.hpp"
#include "robot_client/lidars/ld06_turns.hpp"
#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"

#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// An LD06, or another lidar that sends its packets: LD19, STL-27L. It starts by itself and receives nothing.
class Ld06Driver final : public LidarDriver {
public:
    /// @param title   with its article: "an LD06"
    /// @param sensor  its description
    Ld06Driver(std::string title, std::shared_ptr<const Sensor> sensor, const LidarScanOptions& options)
        : title_(std::move(title)), sensor_(std::move(sensor)), options_(options) {}

    [[nodiscard]] LidarStep on_open() override;
    [[nodiscard]] LidarStep on_bytes(std::span<const std::uint8_t> bytes, double arrival) override;
    [[nodiscard]] LidarStep on_timeout() override { return {}; }
    [[nodiscard]] std::optional<Observation> next() override;
    [[nodiscard]] std::string_view title() const override { return title_; }
    [[nodiscard]] LidarCounts counts() const override { return ld06_counts(decoder_.counts(), turns_); }

private:
    std::string title_;
    std::shared_ptr<const Sensor> sensor_;
    LidarScanOptions options_;
    Ld06Decoder decoder_;
    LidarClock clock_{kLd06ClockWrap};
    Ld06Turns turns_;
};

} // namespace scanloom::robot
