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

struct LinkConfig {
    std::chrono::steady_clock::duration hello_deadline = std::chrono::seconds(5);
    std::chrono::steady_clock::duration idle_deadline = std::chrono::seconds(60); ///< a quiet robot sends pings
    std::chrono::steady_clock::duration farewell_deadline = std::chrono::seconds(2);
    std::size_t credit_bytes = std::size_t{2} << 20; ///< of ScanBatch frames under way; more than one frame
};

/// What a link reaches of the server.
struct LinkServices {
    session::SessionRegistry& sessions;
    boost::asio::any_io_executor may_wait; ///< for work that waits for the disk
    metrics::IngestCounters& counters;
    RequestDesk& desk;
    guard::Gate& gate;
    guard::Audit& audit;
};

/// One robot's connection, from the hello to the farewell.
///
/// hello -> the gate lets the robot in -> the session is found or made and joined -> welcome -> sensor descriptions and
/// scan batches go to the session, acks come back; requests go to the desk, replies come back -> goodbye, after which
/// what is under way is still acknowledged; an error; or the end of the connection. A fault ends this link with an
/// Error frame and disturbs no other.
/// Thread  run() and everything private on the stream's strand; the listener's calls from any thread.
class RobotLink : public session::RobotListener, public std::enable_shared_from_this<RobotLink> {
public:
    /// Pre: the stream's executor is a strand.
    RobotLink(net::LinkStream stream, LinkServices services, const LinkConfig& config);

    [[nodiscard]] boost::asio::any_io_executor executor() { return stream_.get_executor(); }

    /// `told` is called once when the robot has said hello, on the link's strand. Pre: before run().
    void when_greeted(std::function<void()> told) { greeted_ = std::move(told); }

    /// Closes the connection without a word; run() ends. Thread: any.
    void cut_off();

    /// Serves the robot to the end. Never throws.
    boost::asio::awaitable<void> run();

    /// Only tells the robot why it is not served, in place of run(). Never throws.
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
    std::string peer_;    // with its port
    std::function<void()> greeted_;

    wire::FrameDecoder decoder_{wire::kFrameBytesMaxBeforeHello};
    std::size_t frame_bytes_ = 0;       // of the frame last received, with its length prefix
    std::shared_ptr<guard::Pass> pass_; // from the hello on
    Allowance allowance_;               // as its token was when it last allowed this
    std::string robot_;
    std::size_t asked_ = 0; // requests that are being met
    std::shared_ptr<std::atomic<bool>> is_gone_ =
        std::make_shared<std::atomic<bool>>(false); // closed: for who meets them
    bool parting_ = false;                          // nothing more is said or heard

    std::chrono::steady_clock::time_point read_; // when bytes were read off the socket last

    Outbox outbox_;
    LinkWriter writer_;
    Dialogue dialogue_;                   // from the welcome on
    boost::asio::steady_timer held_back_; // until more may be read
    boost::asio::steady_timer settled_;   // never runs out; cancelled when nothing is under way any more

    std::optional<Error> ended_by_; // why the link ends, when not by the peer
    boost::asio::cancellation_signal stop_reading_;
    boost::asio::steady_timer deadline_timer_;
    std::chrono::steady_clock::time_point deadline_;
};

/// Whether the same hello may succeed later.
[[nodiscard]] bool is_retryable(Errc code) noexcept;

} // namespace scanloom::ingest
