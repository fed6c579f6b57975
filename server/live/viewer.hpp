#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "common/net/web_socket.hpp"
#include "server/live/dialogue.hpp"
#include "server/live/live_config.hpp"
#include "server/live/viewed_session.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sessions/listeners.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::live {

/// One live viewer: a WebSocket that shows a session, from the handshake to the close.
///
/// The session only notifies the viewer of changes. The Dialogue's next messages are created from the state of the
/// session when the previous ones are written and the interval is over. So a slow viewer gets the newest state instead
/// of a backlog. It needs the memory of one turn, and of kReceivedBytesMax for what it sent.
///
/// The connection is closed with a reason and one of these codes: 1001 the server shuts down or the session is
/// evicted, 1008 more messages of the viewer wait than kReceivedBytesMax, 1009 message longer than request_bytes_max,
/// 1011 internal error, 4401 the token is no longer valid, 4404 the session was deleted, and those of the dialogue. It
/// is closed without a code if the client disconnects or violates the WebSocket protocol, or if a timeout expires.
/// Threads: the socket's executor, a strand. next_step() runs on `showing` while the coroutine on the strand waits for
/// it. on_changed(), stop() and abort() may be called from any thread.
class Viewer final : public sessions::Watcher, public std::enable_shared_from_this<Viewer> {
public:
    using Upgrade = boost::beast::http::request<boost::beast::http::string_body>;

    /// Of a viewer's messages that wait for the next turn, with some bytes for each.
    static constexpr std::size_t kReceivedBytesMax = std::size_t{1} << 20;

    /// Shared by all viewers.
    struct Services {
        LiveConfig config;
        boost::asio::any_io_executor showing; ///< creates messages
        boost::asio::any_io_executor finding; ///< searches for landmarks, which waits for the disk
        metrics::LiveCounters& counters;
    };

    /// @param permit  to view the session; kept until the viewer is destroyed
    Viewer(net::LinkStream stream, ViewedSession viewed, limits::Semaphore::Permit permit, Services services);

    /// Answers the upgrade request and sends messages until the connection is closed. Call once.
    [[nodiscard]] boost::asio::awaitable<void> run(const Upgrade& upgrade);

    /// Closes the connection with code 1001 within config.farewell.
    void stop();

    /// Closes the connection immediately.
    void abort();

    void on_changed() noexcept override;

private:
    using Clock = std::chrono::steady_clock;
    using Close = boost::beast::websocket::close_reason;

    /// The next step of the viewer.
    struct NextStep {
        Dialogue::Turn turn;
        std::optional<Close> end;
    };

    [[nodiscard]] boost::asio::awaitable<bool> accept(const Upgrade& upgrade);
    [[nodiscard]] boost::asio::awaitable<void> read_requests();
    [[nodiscard]] boost::asio::awaitable<void> send_turns();
    [[nodiscard]] boost::asio::awaitable<void> wait_for_turn();
    [[nodiscard]] boost::asio::awaitable<bool> send(const ViewerMessage& message);
    [[nodiscard]] boost::asio::awaitable<void> close();
    [[nodiscard]] NextStep next_step(const std::vector<ViewerMessage>& received);
    void keep_message();
    void end(Close why);
    void wake();
    void cut_off_after(std::chrono::milliseconds time);

    net::WebSocket stream_;
    boost::beast::flat_buffer buffer_; // at most request_bytes_max
    ViewedSession viewed_;
    limits::Semaphore::Permit permit_;
    Services services_;
    std::unique_ptr<Dialogue> dialogue_; // not used by the strand while next_step() runs
    boost::asio::steady_timer turn_;
    boost::asio::steady_timer deadline_;
    Clock::time_point due_; // the next turn does not begin before
    Clock::time_point look_again_ = Clock::time_point::max();
    std::vector<ViewerMessage> received_; // not yet passed to the dialogue
    std::size_t received_bytes_ = 0;
    bool changed_ = true; // the state may have changed since the last turn
    bool reading_ = false;
    std::optional<Close> ending_;
    std::atomic<bool> notified_ = false; // on_changed() was called since next_step() last read the state
};

} // namespace scanloom::live
