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

/// A serial device, or a pseudo-terminal.
struct SerialDevice {
    std::string path;
};

/// What carries a serial line over TCP, byte for byte (ser2net, raw).
struct TcpPeer {
    std::string host;
    std::string port;
};

using Ld06Endpoint = std::variant<SerialDevice, TcpPeer>;

/// As people write it.
[[nodiscard]] std::string name_of(const Ld06Endpoint& endpoint);

/// An open line to a sensor, which only talks.
/// Thread  that of the executor which awaits.
using Ld06Link = std::variant<boost::asio::serial_port, boost::asio::ip::tcp::socket>;

/// Serial devices are set to 230400 baud, 8 data bits, no parity, 1 stop bit, no flow control.
/// Errors  kUnreachable: it cannot be opened, set, or reached within `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<Ld06Link>> open_link(Ld06Endpoint endpoint,
                                                                 std::chrono::milliseconds timeout);

/// @return how many bytes came, 1 or more.
/// Errors  kUnreachable: the other end hung up, or reading failed; kTimeout: nothing came for `timeout`.
[[nodiscard]] boost::asio::awaitable<Result<std::size_t>> read_some(Ld06Link& link, std::span<std::uint8_t> bytes,
                                                                    std::chrono::milliseconds timeout);

} // namespace scanloom::robot
