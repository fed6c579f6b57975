#pragma once

#include "server/live/live_config.hpp"
#include "server/live/viewed_session.hpp"
#include "server/sessions/session.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::live {

/// A message over the WebSocket of a viewer.
struct ViewerMessage {
    std::string bytes;                                 ///< the message, or its beginning
    std::shared_ptr<const std::string> rest = nullptr; ///< follows `bytes`; other viewers may share it
    bool is_text = false;                              ///< otherwise binary
};

/// Returns why a connection is closed, in words that fit a control frame.
[[nodiscard]] boost::beast::websocket::close_reason close_with(boost::beast::websocket::close_code code,
                                                               std::string_view reason);

/// Decodes the messages of a viewer, and creates those of the server, without a socket.
///
/// Messages show the newest state; states in between are left out, so there is no backlog.
/// Threads: one at a time.
class Dialogue {
public:
    using Clock = std::chrono::steady_clock;
    using SessionPtr = std::shared_ptr<sessions::Session>;

    /// What the viewer gets now.
    struct Turn {
        std::vector<ViewerMessage> messages;                     ///< empty: nothing is new
        Clock::time_point look_again = Clock::time_point::max(); ///< time of the next turn, even without a change
    };

    virtual ~Dialogue() = default;

    /// Handles a message of the viewer.
    /// @return why the connection must be closed, if the message is invalid
    [[nodiscard]] virtual std::optional<boost::beast::websocket::close_reason>
    receive(const ViewerMessage& message) = 0;

    /// Returns what is new.
    /// @param session  the viewed one, in memory
    [[nodiscard]] virtual Turn next(const SessionPtr& session, Clock::time_point now) = 0;
};

/// What dialogues need in addition to the session.
struct DialogueServices {
    const LiveConfig& config;
    boost::asio::any_io_executor finding; ///< searches for landmarks and makes whole maps, which takes long
};

/// Returns the dialogue of viewed.protocol.
[[nodiscard]] std::unique_ptr<Dialogue> make_dialogue(const ViewedSession& viewed, const DialogueServices& services);

} // namespace scanloom::live
