#pragma once

#include "common/error/error.hpp"
#include "common/net/link_stream.hpp"
#include "common/net/websocket_teardown.hpp"
#include "server/live/core/narrator.hpp"
#include "server/live/invitation.hpp"
#include "server/live/live_config.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/watchers.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::live {

/// One WebSocket on which a session is watched, from the handshake to the end.
///
/// The session says that something has changed, no more; the viewer's next event is made when the one before is
/// written and its time has come, from what the session shows then. So a slow viewer gets the newest state, never a
/// backlog, and costs one event's memory; the session knows nothing of it.
///
/// Ends with one of these codes, and a reason: 1001 the server shuts down or the session is read again, 1003 a text
/// message, 1007 no LiveRequest, 1009 a message of more than request_bytes_max, 1011 a fault of ours, 4401 its token is
/// no longer in force, 4404 the session was deleted; without a code
/// when the viewer hangs up, breaks the protocol of the WebSocket, or a deadline passes.
/// Thread  everything on the socket's executor, a strand, but narrate(), which runs on `showing` while the strand's
///         coroutine waits for it; on_changed(), stop() and abort() may be called from any.
class Viewer final : public session::Watcher, public std::enable_shared_from_this<Viewer> {
public:
    using Upgrade = boost::beast::http::request<boost::beast::http::string_body>;

    /// What all viewers share.
    struct Services {
        LiveConfig config;
        boost::asio::any_io_executor showing; ///< where events are made
        boost::asio::any_io_executor finding; ///< where landmarks are, from the disk
        metrics::LiveCounters& counters;
    };

    /// `seat` is kept as long as this.
    Viewer(net::LinkStream stream, Invitation invitation, std::shared_ptr<const void> seat, Services services);

    /// Answers the upgrade, tells what happens, returns when the connection is closed. Call once.
    [[nodiscard]] boost::asio::awaitable<void> run(const Upgrade& upgrade);

    /// Says goodbye and closes, within config.farewell.
    void stop();

    /// Closes at once.
    void abort();

    void on_changed() noexcept override;

private:
    using Clock = std::chrono::steady_clock;
    using Close = boost::beast::websocket::close_reason;

    /// The next event as it goes over the wire; or nothing new; or the end.
    struct Narration {
        std::optional<std::string> event;
        std::optional<Close> end;
        Clock::time_point look_again = Clock::time_point::max(); // even if nobody says that something has changed
    };

    [[nodiscard]] boost::asio::awaitable<bool> accept(const Upgrade& upgrade);
    [[nodiscard]] boost::asio::awaitable<void> read_requests();
    [[nodiscard]] boost::asio::awaitable<void> tell_events();
    [[nodiscard]] boost::asio::awaitable<void> wait_for_turn();
    [[nodiscard]] boost::asio::awaitable<bool> send(const std::string& event);
    [[nodiscard]] boost::asio::awaitable<void> close();
    [[nodiscard]] Narration narrate();
    [[nodiscard]] Clock::time_point add_landmarks(const std::shared_ptr<const session::Session>& session,
                                                  Moment& moment);
    [[nodiscard]] std::optional<Close> fault_of_message();
    void end(Close why);
    void wake();
    void cut_off_after(std::chrono::milliseconds time);

    boost::beast::websocket::stream<net::LinkStream, false> stream_; // false: nothing is ever compressed
    boost::beast::flat_buffer buffer_;                               // as long as a message may be
    Invitation invitation_;
    std::shared_ptr<const void> seat_;
    Services services_;
    Narrator narrator_; // of whoever runs narrate()
    boost::asio::steady_timer turn_;
    boost::asio::steady_timer deadline_;
    Clock::time_point due_; // the next event is not sent before
    Clock::time_point look_again_ = Clock::time_point::max();
    std::optional<Wishes> wishes_; // that the narrator does not know yet
    bool changed_ = true;          // something may be new
    bool reading_ = false;
    std::optional<Close> ending_;
    std::atomic<bool> told_ = false; // on_changed() is on its way to the strand, or nobody has looked since
};

} // namespace scanloom::live
