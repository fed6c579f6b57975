#pragma once

#include "robot_client/lidars/hokuyo_scip.hpp"
#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace scanloom::robot {

/// A Hokuyo that speaks SCIP 2, over TCP or a serial line. The driver asks for its version and its parameters, and
/// starts an endless measurement (MD).
///
/// A scan is the sensor's field of view, with the sensor's own fixed angles, counter-clockwise. Values below the
/// sensor's least range are its error codes, and so invalid. The sensor sends a scan when its last beam was taken, with
/// the time of its own clock. Therefore the stamp is that time by the clock of this machine, less half of the scan's
/// duration.
class HokuyoDriver final : public LidarDriver {
public:
    /// @param options  a range_min or range_max of 0 is the sensor's; the confidence has no meaning
    explicit HokuyoDriver(const LidarScanOptions& options) : options_(options) {}

    [[nodiscard]] LidarStep on_open() override;
    [[nodiscard]] LidarStep on_bytes(std::span<const std::uint8_t> bytes, double arrival) override;
    [[nodiscard]] LidarStep on_timeout() override;
    [[nodiscard]] std::vector<std::uint8_t> stop_request() const override;
    [[nodiscard]] std::optional<Observation> next() override;
    [[nodiscard]] std::string_view title() const override { return "a Hokuyo"; }
    [[nodiscard]] LidarCounts counts() const override;

private:
    enum class State { kStopping, kSwitching, kAskingVersion, kAskingParameters, kStarting, kMeasuring };

    [[nodiscard]] std::string command() const;
    [[nodiscard]] LidarStep enter(State state);
    [[nodiscard]] LidarStep ask() const;
    [[nodiscard]] LidarStep take(const ScipReply& reply);
    [[nodiscard]] LidarStep take_parameters(const ScipReply& reply);
    void take_measurement(const ScipReply& reply, LidarStep& step);

    LidarScanOptions options_;
    State state_ = State::kStopping;
    int attempts_ = 0; ///< of the current command
    ScipReader reader_;
    double arrival_ = 0.0;        ///< Unix seconds, of the first bytes of the incomplete reply
    std::string version_;         ///< for people
    std::set<std::string> noted_; ///< what was noted already
    HokuyoParameters parameters_;
    std::shared_ptr<const Sensor> sensor_;
    LidarClock clock_{kHokuyoClockWrap};
    std::deque<Observation> complete_;
    std::uint64_t turns_ = 0;
    std::uint64_t damaged_ = 0;
};

} // namespace scanloom::robot
