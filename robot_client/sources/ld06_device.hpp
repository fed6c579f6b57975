#pragma once

#include "common/error/error.hpp"
#include "common/net/connect.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/serial_port.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <variant>

namespace scanloom::robot {

/// A serial device or a pseudo-terminal.
struct SerialDevice {
    std::string path;
};

/// A device, or a TCP server that passes on a serial line byte by byte (ser2net, raw).
using Ld06Endpoint = std::variant<SerialDevice, net::Address>;

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

struct Ld06DeviceOptions {
    Ld06Endpoint endpoint;
    std::chrono::milliseconds reopen_for{60'000}; ///< how long to reopen a failed device until it sends; 0: never
    std::chrono::milliseconds silent_max{5'000};  ///< a device that sends no byte for this long counts as failed
    std::function<void(const std::string&)> note = [](const std::string&) {}; ///< for people
};

/// Receives the bytes of a device.
class Ld06Listener {
public:
    virtual ~Ld06Listener() = default;

    /// Called when a device was opened: the next bytes do not continue the previous ones.
    virtual void on_open() = 0;
    /// @return whether a packet ended within the bytes
    virtual bool on_bytes(std::span<const std::uint8_t> bytes) = 0;
};

/// Reads a device until it fails permanently. A device that fails after it was opened is reopened, after waits that
/// double from 0.1 s to 2 s, until it sends packets or reopen_for is over. Notes report when the device fails, when it
/// is back, and when it sends bytes that are not packets.
///
/// @return the reason for the end: kShuttingDown if cancelled, else the error of the link
[[nodiscard]] boost::asio::awaitable<Error> read_ld06_device(Ld06DeviceOptions options, Ld06Listener& listener);

} // namespace scanloom::robot
