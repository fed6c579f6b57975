#pragma once

#include "common/error/error.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/serial_port.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

namespace scanloom::robot {

/// A serial device or a pseudo-terminal.
struct SerialDevice {
    std::string path;
};

/// A TCP server that passes on a serial line byte by byte (ser2net, raw).
struct TcpPeer {
    std::string host;
    std::string port;
};

using Ld06Endpoint = std::variant<SerialDevice, TcpPeer>;

/// Returns the endpoint as users write it.
[[nodiscard]] std::string name_of(const Ld06Endpoint& endpoint);

/// An open line to a sensor, which only sends.
/// Threads: that of the awaiting executor.
using Ld06Link = std::variant<boost::asio::serial_port, boost::asio::ip::tcp::socket>;

/// Opens a line. Serial devices are set to 230400 baud, 8 data bits, no parity, 1 stop bit, no flow control.
/// Errors: kUnreachable if it cannot be opened, configured, or reached within `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<Ld06Link>> open_link(Ld06Endpoint endpoint,
                                                                 std::chrono::milliseconds timeout);

/// Reads the bytes that have arrived, at least one.
/// @return number of bytes
/// Errors: kUnreachable if the other end closed the line or reading failed; kTimeout if nothing arrived for `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<std::size_t>> read_some(Ld06Link& link, std::span<std::uint8_t> bytes,
                                                                    std::chrono::milliseconds timeout);

} // namespace scanloom::robot
