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
    std::chrono::milliseconds reopen_for{60'000}; ///< without a packet, since it went away; 0: not at all
    std::chrono::milliseconds silent_max{5'000};  ///< a device without a byte for so long went away, too
    std::function<void(const std::string&)> note = [](const std::string&) {}; ///< for people
};

/// Who takes what a device gives.
class Ld06Listener {
public:
    virtual ~Ld06Listener() = default;

    /// The bytes to come do not continue those before.
    virtual void on_open() = 0;
    /// @return whether there was a packet's end among them.
    virtual bool on_bytes(std::span<const std::uint8_t> bytes) = 0;
};

/// Reads a device for ever. One that goes away, having been opened, is opened again and again, after waits that double
/// from 0.1 s to 2 s, until it gives packets or reopen_for is over. People are told when it goes, when it is back, and
/// when it gives bytes that are no packets.
///
/// @return why it is over: kShuttingDown where it was cancelled; else that of the link.
[[nodiscard]] boost::asio::awaitable<Error> read_ld06_device(Ld06DeviceOptions options, Ld06Listener& listener);

} // namespace scanloom::robot
