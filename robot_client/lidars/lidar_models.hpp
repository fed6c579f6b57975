#pragma once

#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_scan.hpp"
#include "robot_client/lidars/serial_settings.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace scanloom::robot {

/// The protocol that a lidar speaks, and so its driver.
enum class LidarFamily { kLd06, kRplidar, kYdlidarX2, kYdlidarX4, kHokuyo };

/// A lidar that users can buy. Ranges and rates are those of its data sheet; a range of 0 is asked from the sensor.
struct LidarModel {
    std::string_view name;  ///< on the command line
    std::string_view title; ///< with its article, for messages: "an LD06"
    std::string_view label; ///< name of the sensor on the server
    LidarFamily family;
    SerialSettings serial;
    double range_min = 0.0;  ///< metres
    double range_max = 0.0;  ///< metres
    int confidence_min = 0;  ///< the sensor's own scale; readings below are invalid
    std::uint32_t beams = 0; ///< of a usual turn
};

/// Returns all models, in the order in which help lists them.
[[nodiscard]] std::span<const LidarModel> lidar_models() noexcept;

/// Returns the model of this name, or nullptr.
[[nodiscard]] const LidarModel* find_lidar_model(std::string_view name) noexcept;

/// Values that a user states instead of those of the model.
struct LidarSettings {
    std::optional<double> range_min; ///< metres
    std::optional<double> range_max; ///< metres
    std::optional<NoReturn> no_return;
    std::optional<int> confidence_min;
    std::optional<int> median_window; ///< beams
    Pose2 mount;                      ///< T_robot_sensor
    Poses poses = Poses::kMap;        ///< what the robot's poses are
};

/// Returns how readings of a model are used.
/// Errors: kInvalidField if no reading would be valid.
[[nodiscard]] Result<LidarScanOptions> scan_options(const LidarModel& model, const LidarSettings& settings);

/// Returns the driver of a model. Pre: the options are those of scan_options().
[[nodiscard]] std::unique_ptr<LidarDriver> make_lidar_driver(const LidarModel& model, const LidarScanOptions& options);

} // namespace scanloom::robot
