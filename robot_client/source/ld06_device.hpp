#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/ld06_link.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace scanloom::robot {

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
