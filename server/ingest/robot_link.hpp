#pragma once

#include "common/net/link_stream.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "server/guard/audit.hpp"
#include "server/guard/gate.hpp"
#include "server/ingest/allowance.hpp"
#include "server/ingest/dialogue.hpp"
#include "server/ingest/link_writer.hpp"
#include "server/ingest/outbox.hpp"
#include "server/ingest/request_desk.hpp"
#include "server/log/context.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/session.hpp"
#include "server/session/session_registry.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::ingest {

/// Settings of a RobotLink.
struct LinkConfig {
    std::chrono::steady_clock::duration hello_deadline = std::chrono::seconds(5);    ///< from accepting to the hello
    std::chrono::steady_clock::duration idle_deadline = std::chrono::seconds(60);    ///< an idle robot sends pings
    std::chrono::steady_clock::duration farewell_deadline = std::chrono::seconds(2); ///< for the robot to hang up
    std::size_t credit_bytes = std::size_t{2}
                               << 20; ///< of ScanBatch frames that are not durable yet; more than one frame
};

/// The parts of the server that a link uses.
struct LinkServices {
    session::SessionRegistry& sessions;
    boost::asio::any_io_executor may_wait; ///< for work that waits for the disk
    metrics::IngestCounters& counters;
    RequestDesk& desk;
    guard::Gate& gate;
    guard::Audit& audit;
};

/// One robot's connection, from the hello to its end.
///
/// After the hello, the gate admits the robot, the session is found or created, and the robot joins it and receives a
/// welcome. Then sensor descriptions and scan batches go to the session, which returns acks, and requests go to the
/// desk, which returns replies. The link ends with a goodbye, after which pending scans are still acknowledged; with an
/// error; or with the end of the connection. An error is sent to the robot in an Error frame and does not affect other
/// links.
/// Threads: run() and all private members on the stream's strand; the listener's functions from any thread.
class RobotLink : public session::RobotListener, public std::enable_shared_from_this<RobotLink> {
public:
    /// Pre: the stream's executor is a strand.
    RobotLink(net::LinkStream stream, LinkServices services, const LinkConfig& config);

    [[nodiscard]] boost::asio::any_io_executor executor() { return stream_.get_executor(); }

    /// Sets the callback for the robot's hello. It is called once, on the link's strand. Pre: called before run().
    void when_greeted(std::function<void()> told) { greeted_ = std::move(told); }

    /// Closes the connection without an Error frame; run() ends.
    /// Threads: any thread.
    void cut_off();

    /// Serves the robot until the link ends. Never throws.
    boost::asio::awaitable<void> run();

    /// Sends the robot the reason why it is not served. Called instead of run(). Never throws.
    boost::asio::awaitable<void> turn_away(wire::LinkError why);

    void on_durable(std::uint64_t durable_seq, std::size_t bytes) override;
    void on_failed(const Error& error) override;

private:
    boost::asio::awaitable<Result<>> serve();
    boost::asio::awaitable<bool> shake_hands();
    boost::asio::awaitable<Result<>> settle();
    [[nodiscard]] Result<> let_in(const wire::Hello& hello);
    boost::asio::awaitable<Result<>> enter(wire::Hello hello);
    boost::asio::awaitable<Result<wire::Message>> receive();
    boost::asio::awaitable<void> hold_back(double seconds);
    [[nodiscard]] Result<> handle(wire::Message message);
    [[nodiscard]] Result<> ask(Request request);
    void answer(std::string frame, std::shared_ptr<const void> slot);
    [[nodiscard]] Error over_limit(Error error) const;
    boost::asio::awaitable<void> watch_deadline();
    boost::asio::awaitable<void> farewell(wire::LinkError why);
    boost::asio::awaitable<void> part();
    boost::asio::awaitable<void> let_hang_up();
    void tell_end(std::string_view how, bool was_let_in) const;
    [[nodiscard]] std::string who_ended() const;
    [[nodiscard]] log::Context about() const;
    void start_watch();
    void hang_up();
    void end(const Error& error);
    void look_at_pass();
    void note_refusal(access::Reason reason, const std::string& token, const std::string& session) const;
    void expect_something_within(std::chrono::steady_clock::duration time);

    net::LinkStream stream_;
    LinkServices services_;
    LinkConfig config_;
    std::string address_; // of the peer
    std::string peer_;    // address with the port
    std::function<void()> greeted_;

    wire::FrameDecoder decoder_{wire::kFrameBytesMaxBeforeHello};
    std::size_t frame_bytes_ = 0;       // of the last frame received, with its length prefix
    std::shared_ptr<guard::Pass> pass_; // set by the hello
    Allowance allowance_;               // with the token that last permitted the link
    std::string robot_;
    std::size_t asked_ = 0; // requests that the desk has not answered yet
    std::shared_ptr<std::atomic<bool>> is_gone_ =
        std::make_shared<std::atomic<bool>>(false); // the link is closed; read by the desk
    bool parting_ = false;                          // no more messages are queued or read

    std::chrono::steady_clock::time_point read_; // when bytes were last read from the socket

    Outbox outbox_;
    LinkWriter writer_;
    Dialogue dialogue_;                   // used after the robot has joined
    boost::asio::steady_timer held_back_; // expires when more may be read
    boost::asio::steady_timer settled_;   // never expires; cancelled to let settle() check again

    std::optional<Error> ended_by_; // why this side ends the link, if it does
    boost::asio::cancellation_signal stop_reading_;
    boost::asio::steady_timer deadline_timer_;
    std::chrono::steady_clock::time_point deadline_;
};

/// Returns whether the same hello may succeed later.
[[nodiscard]] bool is_retryable(Errc code) noexcept;

} // namespace scanloom::ingest
