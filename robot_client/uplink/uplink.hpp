#pragma once

#include "common/link/client_protocol.hpp"
#include "common/net/connect.hpp"
#include "common/net/server_list.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "robot_client/uplink/backoff.hpp"
#include "robot_client/uplink/feed.hpp"
#include "robot_client/uplink/send_buffer.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

struct UplinkOptions {
    std::vector<net::Address> servers;                    ///< at least one; the next one if one cannot be used
    net::TlsContext tls;                                  ///< none: the link is not encrypted
    link::ClientProtocolOptions protocol;                 ///< `server` is set by the Uplink
    std::size_t buffer_bytes_max = std::size_t{32} << 20; ///< of unacknowledged scans; when full, the source waits
    std::chrono::milliseconds connect_timeout{10'000};
    std::chrono::milliseconds give_up_after{120'000};     ///< without progress; 0 = never
    std::chrono::milliseconds give_up_after_end{120'000}; ///< as give_up_after, once the feed has ended
    std::chrono::milliseconds drain_max{10'000};          ///< how long stop() waits for acknowledgements
    std::uint32_t backoff_seed = 1;
    BackoffWaits backoff; ///< before reconnecting after a failed link
    /// Called for each link that failed and is going to be replaced.
    std::function<void(const Error&)> on_trouble = [](const Error&) {};
};

/// Progress of an uplink, for messages and the summary.
struct UplinkStatus {
    std::uint64_t resumed_after = 0; ///< scans the server had from earlier runs
    std::uint64_t last = 0;          ///< highest seq taken from the source, or resumed_after
    std::uint64_t acknowledged = 0;  ///< highest durable seq
    std::uint64_t sent = 0;          ///< scans sent in this run, each counted once
    std::uint64_t bytes = 0;         ///< sent, including repeated ones
    std::uint64_t reconnects = 0;
    std::uint64_t waiting = 0; ///< scans taken that follow `last`, in a spool
    std::uint64_t dropped = 0; ///< scans taken and lost for lack of room
    bool is_linked = false;
    std::optional<std::chrono::duration<double>> next_scan_in = {}; ///< only during a long pause
};

/// Carries a feed's scans to the server; connects and reconnects. It owns the sockets and timers;
/// link::ClientProtocol implements the protocol.
///
/// Threads: everything runs on the one thread of `io`. All functions must be called on it.
class Uplink final : private Intake {
public:
    Uplink(boost::asio::io_context& io, UplinkOptions options, Feed& feed);

    /// Completes when every scan of the feed is durable.
    /// Errors: the server's, if it is not retryable; kTimeout if there is no progress for give_up_after, or if not all
    ///         sent scans were acknowledged within drain_max of stop(); those of outcome_when_interrupted(); those of
    ///         the feed.
    [[nodiscard]] boost::asio::awaitable<Result<>> run();

    /// Takes no more scans from the feed. run() completes once the scans taken are durable, or after drain_max.
    void stop();

    /// Returns the result of run() if it is abandoned now, after stop().
    /// Errors: kShuttingDown if scans taken are not acknowledged, or if the feed has an end and has not reached it.
    [[nodiscard]] Result<> outcome_when_interrupted() const;

    /// Adds a request as ClientProtocol::ask() does; it is sent as soon as there is a link. `answered` runs on the
    /// thread of `io`.
    [[nodiscard]] std::optional<std::uint64_t> ask(link::Request request, link::Answered answered);
    /// Drops the callback of a request: its reply is no longer needed.
    void abandon(std::uint64_t id) { protocol_.abandon(id); }

    /// Completes when all scans taken so far are in the server's maps.
    [[nodiscard]] boost::asio::awaitable<void> until_applied();

    /// Returns the signal for when a message arrives from the server and when a link has ended.
    [[nodiscard]] WakeSignal& change_signal() noexcept { return changed_; }

    [[nodiscard]] UplinkStatus status() const;
    /// Returns the highest seq known to be in the server's maps.
    [[nodiscard]] std::uint64_t applied() const noexcept { return protocol_.applied(); }
    /// Returns a message for people that explains why there is no progress.
    [[nodiscard]] std::string what_is_wrong() const;
    [[nodiscard]] boost::asio::io_context::executor_type executor() const { return io_.get_executor(); }

private:
    using Clock = std::chrono::steady_clock;

    // Intake
    [[nodiscard]] std::optional<std::uint64_t> resumed_after() const override { return protocol_.resumed_after(); }
    [[nodiscard]] const std::string& session_id() const override { return protocol_.session_id(); }
    [[nodiscard]] bool has_room() const override { return buffer_.has_room(); }
    void add(Observation observation) override;
    bool drop_oldest_unsent() override { return buffer_.drop_oldest_unsent(); }
    [[nodiscard]] bool is_stopped() const override { return stopped_.has_value(); }
    [[nodiscard]] boost::asio::awaitable<void> wait_for_change(Time until) override { return wait(feed_wake_, until); }
    void wake() override { feed_wake_.cancel(); }

    [[nodiscard]] boost::asio::awaitable<void> take_from_feed();
    [[nodiscard]] boost::asio::awaitable<void> keep_linked();
    [[nodiscard]] boost::asio::awaitable<void> watch_progress();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> use_one_link();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> read_frames(net::LinkStream& stream);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> write_frames(net::LinkStream& stream);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> watch_link();
    [[nodiscard]] wire::LinkError closed(const net::LinkStream& stream, const boost::system::error_code& failed) const;
    [[nodiscard]] std::optional<wire::LinkError> take(std::size_t bytes);
    [[nodiscard]] std::optional<Error> reason_to_give_up() const;

    /// Waits until `time` or until the timer is cancelled. The coroutines wake one another by cancelling timers.
    [[nodiscard]] static boost::asio::awaitable<void> wait(boost::asio::steady_timer& timer, Clock::time_point time);
    void wake_all();

    boost::asio::io_context& io_;
    UplinkOptions options_;
    Feed& feed_;
    SendBuffer buffer_;
    link::ClientProtocol protocol_;
    net::ServerList servers_;
    Backoff backoff_;
    boost::asio::steady_timer feed_wake_;
    boost::asio::steady_timer write_wake_;
    boost::asio::steady_timer progress_wake_;
    WakeSignal changed_;
    Result<> outcome_;
    std::optional<Error> last_trouble_;
    std::optional<Clock::time_point> stopped_;
};

/// Makes a UplinkOptions::on_trouble that reports repeated identical errors only once.
/// @param on_message  receives messages for people
[[nodiscard]] std::function<void(const Error&)> report_once(std::function<void(const std::string&)> on_message);

} // namespace scanloom::robot
