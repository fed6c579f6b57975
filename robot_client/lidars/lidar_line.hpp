#pragma once

#include "common/error/error.hpp"
#include "common/net/connect.hpp"
#include "robot_client/lidars/serial_settings.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/serial_port.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace scanloom::robot {

/// A serial device or a pseudo-terminal.
struct SerialDevice {
    std::string path;
};

/// A device, or a TCP server: the sensor itself, or a program that passes on a serial line byte by byte (ser2net, raw).
using LidarEndpoint = std::variant<SerialDevice, net::Address>;

/// Returns the endpoint as users write it.
[[nodiscard]] std::string name_of(const LidarEndpoint& endpoint);

/// An open line to a lidar.
/// Threads: that of the awaiting executor.
using LidarLine = std::variant<boost::asio::serial_port, boost::asio::ip::tcp::socket>;

/// Opens a line. Serial devices are set to `settings`, 8 data bits, no parity, 1 stop bit, no flow control. A device
/// without a line DTR, such as a pseudo-terminal, is opened all the same.
/// Errors: kUnreachable if it cannot be opened, configured, or reached within `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<LidarLine>> open_line(LidarEndpoint endpoint, SerialSettings settings,
                                                                  std::chrono::milliseconds timeout);

/// Sets the rate of an open serial device and drops the bytes that were received at the earlier one. Does nothing over
/// TCP.
/// Errors: kUnreachable if the device cannot be set to this rate.
[[nodiscard]] Result<> set_baud(LidarLine& line, unsigned baud);

/// Reads the bytes that have arrived, at least one.
/// @return number of bytes, or nullopt if nothing arrived for `timeout`
/// Errors: kUnreachable if the other end closed the line or reading failed.
[[nodiscard]] boost::asio::awaitable<Result<std::optional<std::size_t>>>
read_some(LidarLine& line, std::span<std::uint8_t> bytes, std::chrono::milliseconds timeout);

/// Writes all bytes.
/// Errors: kUnreachable if the line was closed or does not accept the bytes for `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<>> write_all(LidarLine& line, std::span<const std::uint8_t> bytes,
                                                         std::chrono::milliseconds timeout);

/// Writes the last bytes of a line that is about to be closed, as many as it accepts at once. Errors are ignored.
void write_last(LidarLine& line, std::span<const std::uint8_t> bytes) noexcept;

} // namespace scanloom::robot
