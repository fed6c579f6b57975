#pragma once

#include "common/error/error.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_line.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <functional>
#include <string>

namespace scanloom::robot {

struct LidarReaderOptions {
    LidarEndpoint endpoint;
    SerialSettings serial;
    std::chrono::milliseconds reopen_for{60'000}; ///< how long to reopen a failed device until it sends; 0: never
    std::chrono::milliseconds silent_max{5'000};  ///< a device that sends no byte for this long counts as failed
    std::function<void(const std::string&)> note = [](const std::string&) {}; ///< for people
};

/// Runs a driver on a line until the device fails permanently. A device that fails after it was opened is reopened,
/// after waits that double from 0.1 s to 2 s, until it sends packets or reopen_for is over. Notes report when the
/// device fails, when it is back, and when it sends bytes that are not packets. Whenever a line is closed, the driver's
/// stop_request() is written, also if the coroutine is destroyed.
///
/// @param driver    must outlive the coroutine
/// @param on_input  called after the driver received bytes: it may have scans
/// @return the reason for the end: kShuttingDown if cancelled, else the error of the line or of the driver
[[nodiscard]] boost::asio::awaitable<Error> read_lidar(LidarReaderOptions options, LidarDriver& driver,
                                                       std::function<void()> on_input);

} // namespace scanloom::robot
