#pragma once

#include "common/error/error.hpp"
#include "common/net/tls.hpp"
#include "robot_client/foxglove/core/bridge_session.hpp"
#include "robot_client/foxglove/url.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "robot_client/uplink/backoff.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct BridgeLinkOptions {
    Url bridge;
    net::TlsContext tls;                           ///< for wss
    std::chrono::milliseconds reopen_for{60'000};  ///< how long to try to connect until it succeeds; 0: once
    std::chrono::milliseconds answer_max{10'000};  ///< for connecting, and for the handshake
    std::chrono::milliseconds info_max{10'000};    ///< then until the bridge says what it is
    std::chrono::milliseconds steady_after{5'000}; ///< a connection that lasts this long has succeeded
    std::chrono::milliseconds silent_max{10'000};  ///< a bridge that does not answer a ping for this long is dead
    BackoffWaits backoff{std::chrono::milliseconds(200), std::chrono::milliseconds(5'000)}; ///< between attempts
    std::uint32_t backoff_seed = 1;
    std::function<void(const std::string&)> note = [](const std::string&) {}; ///< for people
};

/// Receives the frames of a bridge, and has those to send.
class BridgeListener {
public:
    virtual ~BridgeListener() = default;

    /// Called when a connection is open: what was received before does not hold any more.
    virtual void on_open() = 0;
    virtual void on_text(std::string_view text) = 0;
    virtual void on_binary(std::string_view bytes) = 0;
    /// Called when a connection that was open has ended.
    virtual void on_lost() = 0;
    /// Returns whether the bridge has said what it is, on this connection.
    [[nodiscard]] virtual bool is_connected() const = 0;
    [[nodiscard]] virtual std::optional<foxglove::OutgoingFrame> next_frame() = 0;
};

/// Longest frame of a bridge; a longer one ends the connection.
inline constexpr std::size_t kBridgeFrameMax = std::size_t{64} << 20;

/// Reads a bridge until it fails permanently. It connects again, after waits that double, until a connection lasts or
/// reopen_for is over. Notes report when the connection fails, and when it is back. A bridge that is reached and
/// speaks another protocol fails at once, unless an earlier connection succeeded.
///
/// @param options   see BridgeLinkOptions
/// @param listener  must outlive the call, as `to_send`
/// @param to_send   notifies that the listener may have a frame to send
/// @return the reason for the end: kShuttingDown if cancelled, kUnreachable, kTimeout, or kUnsupportedVersion if it
///         speaks neither sub-protocol
[[nodiscard]] boost::asio::awaitable<Error> read_bridge(BridgeLinkOptions options, BridgeListener& listener,
                                                        WakeSignal& to_send);

} // namespace scanloom::robot
