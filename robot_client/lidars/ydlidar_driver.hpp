#pragma once

#include "robot_client/lidars/a5_handshake.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"
#include "robot_client/lidars/marked_turns.hpp"
#include "robot_client/lidars/ydlidar_packet.hpp"

#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A YDLIDAR that measures by triangulation. An X4 is asked what it is and is started; an X2 starts by itself and
/// receives nothing. A scan is one turn; its times are those of arrival.
class YdlidarDriver final : public LidarDriver {
public:
    /// @param title       with its article: "a YDLIDAR X4"
    /// @param is_started  the driver starts the sensor
    /// @param sensor      its description
    YdlidarDriver(std::string title, bool is_started, std::shared_ptr<const Sensor> sensor,
                  const LidarScanOptions& options);

    [[nodiscard]] LidarStep on_open() override;
    [[nodiscard]] LidarStep on_bytes(std::span<const std::uint8_t> bytes, double arrival) override;
    [[nodiscard]] LidarStep on_timeout() override { return handshake_.on_timeout(); }
    [[nodiscard]] std::vector<std::uint8_t> stop_request() const override;
    [[nodiscard]] std::optional<Observation> next() override;
    [[nodiscard]] std::string_view title() const override { return title_; }
    [[nodiscard]] LidarCounts counts() const override;

private:
    [[nodiscard]] bool take_packets(std::span<const std::uint8_t> bytes, double arrival);

    std::string title_;
    bool is_started_;
    std::shared_ptr<const Sensor> sensor_;
    LidarScanOptions options_;
    A5Handshake handshake_;
    bool is_measuring_ = false;
    YdlidarDecoder decoder_;
    MarkedTurns turns_{kYdlidarStepsPerTurn};
};

} // namespace scanloom::robot
