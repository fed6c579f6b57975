#pragma once

#include "common/error/error.hpp"
#include "robot_client/lidars/lidar_line.hpp"
#include "robot_client/lidars/lidar_probe.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Returns the serial devices of USB adapters: names by maker and serial number (serial/by-id), which stay the same
/// when devices are plugged in in another order, and those that have no such name (ttyUSB0, ttyACM0). Sorted.
/// @param dev  the directory of devices
[[nodiscard]] std::vector<std::string> serial_devices(const std::filesystem::path& dev = "/dev");

/// Makes all attempts of lidar_probes() on a line, one after another, until a lidar answers.
/// @param answer_within  time that each lidar has to answer or to send some packets
/// @return the lidar, or nullopt if none answers
/// Errors: kUnreachable if the line cannot be opened, set or read.
[[nodiscard]] boost::asio::awaitable<Result<std::optional<LidarIdentity>>>
identify_lidar(LidarEndpoint endpoint, std::chrono::milliseconds answer_within);

} // namespace scanloom::robot
