#pragma once

#include "common/link/server_protocol.hpp"
#include "common/net/link_stream.hpp"
#include "server/auth/audit_log.hpp"
#include "server/auth/authenticator.hpp"
#include "server/ingest/link_permission.hpp"
#include "server/ingest/request_executor.hpp"
#include "server/ingest/unacknowledged.hpp"
#include "server/log/context.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_registry.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace scanloom::ingest {

/// The parts of the server that a connection uses.
struct LinkServices {
    sessions::SessionRegistry& sessions;
    boost::asio::any_io_executor blocking_executor; ///< for work that waits for the disk
    metrics::IngestCounters& counters;
    RequestExecutor& requests;
    auth::Authenticator& authenticator;
    auth::AuditLog& audit;
};

/// One robot's connection: the sockets, timers and services around a link::ServerProtocol, which decides what happens.
///
/// Threads: all private members on the stream's strand; public functions from any thread.
class RobotConnection : public sessions::RobotListener, public std::enable_shared_from_this<RobotConnection> {
public:
    /// Pre: the stream's executor is a strand.
    RobotConnection(net::LinkStream stream, LinkServices services, const link::ServerProtocolConfig& config);

    /// Serves the robot until the link ends.
    /// @param on_hello   called when the robot's hello has arrived
    /// @param on_closed  called once, when the connection is closed
    void serve(std::function<void()> on_hello, std::function<void()> on_closed);

    /// Sends the robot the reason why it is not served. Called instead of serve().
    void turn_away(wire::LinkError why, std::function<void()> on_closed);

    /// Closes the connection without an Error frame.
    void cut_off();

    void on_durable(std::uint64_t durable_seq, std::size_t bytes) override;
    void on_located(const sessions::Located& located) override;
    void on_failed(const Error& error) override;

private:
    using Clock = std::chrono::steady_clock;

    template <class Event>
    void handle(Event event);
    template <class Event>
    void post(Event event);
    template <class Done>
    [[nodiscard]] auto on_strand(Done done);
    void open();
    void start_read();
    void watch_deadline();

    void perform(link::ServerProtocol::Join&& action);
    void perform(link::ServerProtocol::SubmitSensor&& action);
    void perform(link::ServerProtocol::SubmitScans&& action);
    void perform(link::ServerProtocol::AnswerRequest&& action);
    void perform(link::ServerProtocol::RecordLimit&& action);
    void perform(link::ServerProtocol::Leave&& action);
    void perform(link::ServerProtocol::Send&& action);
    void perform(link::ServerProtocol::ShutDownSending&& action);
    void perform(link::ServerProtocol::Close&& action);

    static boost::asio::awaitable<void> join(std::shared_ptr<RobotConnection> self, wire::Hello hello);
    boost::asio::awaitable<Result<link::ServerProtocol::Joined>> enter(const wire::Hello& hello);
    void name_server_of(const std::string& session, const Error& why);
    void log_end() const;

    net::LinkStream stream_;
    LinkServices services_;
    std::string address_; // of the peer
    std::string peer_;    // address with the port
    std::function<void()> on_hello_;
    std::function<void()> on_closed_;

    link::ServerProtocol protocol_;
    bool is_serving_ = false; // serve() was called
    bool is_reading_ = false; // a read or the TLS handshake is running
    link::ServerProtocol::Send sending_;
    boost::asio::steady_timer timer_;
    Clock::time_point timer_expiry_ = Clock::time_point::max(); // max: the timer is not running

    LinkPermission permission_;
    std::string robot_;
    std::shared_ptr<sessions::Session> session_; // joined
    RobotIndex robot_index_ = 0;                 // in the session
    Unacknowledged unacknowledged_;
    std::shared_ptr<std::atomic<bool>> is_gone_ =
        std::make_shared<std::atomic<bool>>(false); // no reply is needed any more; read by the RequestExecutor
};

} // namespace scanloom::ingest
