#pragma once

#include "robot_client/lidars/a5_handshake.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"
#include "robot_client/lidars/marked_turns.hpp"
#include "robot_client/lidars/rplidar_packet.hpp"

#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// An RPLIDAR: A1, A2, C1 and others that send single points. Those of the A series from firmware 1.17 on send express
/// capsules, which have twice as many points. A scan is one turn; its times are those of arrival.
class RplidarDriver final : public LidarDriver {
public:
    /// @param title   with its article: "an RPLIDAR A1"
    /// @param sensor  its description
    RplidarDriver(std::string title, std::shared_ptr<const Sensor> sensor, const LidarScanOptions& options);

    [[nodiscard]] LidarStep on_open() override;
    [[nodiscard]] LidarStep on_bytes(std::span<const std::uint8_t> bytes, double arrival) override;
    [[nodiscard]] LidarStep on_timeout() override { return handshake_.on_timeout(); }
    [[nodiscard]] std::vector<std::uint8_t> stop_request() const override;
    [[nodiscard]] std::optional<Observation> next() override;
    [[nodiscard]] std::string_view title() const override { return title_; }
    [[nodiscard]] LidarCounts counts() const override;

private:
    [[nodiscard]] bool take_points(std::span<const std::uint8_t> bytes, double arrival);

    std::string title_;
    std::shared_ptr<const Sensor> sensor_;
    LidarScanOptions options_;
    A5Handshake handshake_;
    std::optional<RplidarDecoder> decoder_; ///< of the measurement that was started
    bool has_quality_ = false;
    std::uint64_t damaged_before_ = 0; ///< in earlier measurements
    MarkedTurns turns_{kRplidarStepsPerTurn};
};

} // namespace scanloom::robot
