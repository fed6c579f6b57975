#pragma once

#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"
#include "robot_client/uplink/backoff.hpp"
#include "robot_client/uplink/bell.hpp"
#include "robot_client/uplink/conversation.hpp"
#include "robot_client/uplink/feed.hpp"
#include "robot_client/uplink/server_address.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace scanloom::robot {

struct UplinkOptions {
    ServerAddress server;
    net::TlsContext tls; ///< none: the link is not encrypted
    ConversationOptions conversation;
    std::chrono::milliseconds connect_timeout{10'000};
    std::chrono::milliseconds give_up_after{120'000};     ///< without progress; 0 = never
    std::chrono::milliseconds give_up_after_end{120'000}; ///< likewise, once the feed has ended
    std::chrono::milliseconds drain_max{10'000};          ///< how long stop() waits for acknowledgements
    std::uint32_t backoff_seed = 1;
    BackoffWaits backoff; ///< before a link that failed is replaced
    /// Hears of every link that failed and is going to be replaced.
    std::function<void(const Error&)> on_trouble = [](const Error&) {};
};

/// How far an uplink is, for people and for the summary.
struct UplinkStatus {
    std::uint64_t resumed_after = 0; ///< scans the server held from earlier runs
    std::uint64_t last = 0;          ///< highest seq taken from the source, or resumed_after
    std::uint64_t acknowledged = 0;  ///< highest durable seq
    std::uint64_t sent = 0;          ///< scans that went out in this run, each counted once
    std::uint64_t bytes = 0;         ///< sent, resent ones included
    std::uint64_t reconnects = 0;
    std::uint64_t waiting = 0; ///< scans that were taken and are behind `last`, in a spool
    std::uint64_t dropped = 0; ///< scans that were taken and are lost, for want of room
    bool is_linked = false;
    std::optional<std::chrono::duration<double>> next_scan_in = {}; ///< only in a long pause
};

/// Carries a feed's scans to the server: connects and reconnects. The protocol is Conversation's; here are the sockets
/// and timers.
///
/// Thread  everything runs on the one thread of `io`; all functions are called on it, too.
class Uplink final : private Intake {
public:
    Uplink(boost::asio::io_context& io, UplinkOptions options, Feed& feed);

    /// Completes when every scan of the feed is durable.
    /// Errors  the server's, if it is final; kTimeout when nothing moves for give_up_after or not all sent scans
    ///         were acknowledged within drain_max of stop(); those of outcome_when_interrupted(); those of the feed.
    [[nodiscard]] boost::asio::awaitable<Result<>> run();

    /// No more scans from the feed; run() completes once those taken are durable, or after drain_max.
    void stop();

    /// What it comes to when it is left now, after stop().
    /// Errors  kShuttingDown: scans were taken and not acknowledged, or the feed has an end and is not there yet.
    [[nodiscard]] Result<> outcome_when_interrupted() const;

    /// Conversation::ask(), sent as soon as there is a link. `answered` is called on the thread of `io`.
    [[nodiscard]] std::optional<std::uint64_t> ask(Request request, Answered answered);
    /// Nobody waits for the answer any more.
    void abandon(std::uint64_t id) { conversation_.abandon(id); }

    /// Completes when all scans that were taken by now are in the server's maps.
    [[nodiscard]] boost::asio::awaitable<void> until_applied();

    /// Rings whenever something came from the server, and when a link has ended.
    [[nodiscard]] Bell& news_bell() noexcept { return heard_; }

    [[nodiscard]] UplinkStatus status() const;
    /// The highest seq that is in the server's maps, as far as is known.
    [[nodiscard]] std::uint64_t applied() const noexcept { return conversation_.applied(); }
    /// Why nothing moves, for people.
    [[nodiscard]] std::string what_is_wrong() const;
    [[nodiscard]] boost::asio::io_context::executor_type executor() const { return io_.get_executor(); }

private:
    using Clock = std::chrono::steady_clock;

    // Intake
    [[nodiscard]] std::optional<std::uint64_t> resumed_after() const override { return conversation_.resumed_after(); }
    [[nodiscard]] const std::string& session_id() const override { return conversation_.session_id(); }
    [[nodiscard]] bool has_room() const override { return conversation_.has_room(); }
    void add(Observation observation) override;
    bool drop_oldest_unsent() override { return conversation_.drop_oldest_unsent(); }
    [[nodiscard]] bool is_stopped() const override { return stopped_.has_value(); }
    [[nodiscard]] boost::asio::awaitable<void> news(Time until) override { return wait(feed_wake_, until); }
    void wake() override { feed_wake_.cancel(); }

    [[nodiscard]] boost::asio::awaitable<void> take_from_feed();
    [[nodiscard]] boost::asio::awaitable<void> keep_linked();
    [[nodiscard]] boost::asio::awaitable<void> watch_progress();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> use_one_link();
    [[nodiscard]] boost::asio::awaitable<std::optional<wire::LinkError>> connect(net::LinkStream::Socket& socket);
    [[nodiscard]] boost::asio::awaitable<std::optional<wire::LinkError>> shake_hands(net::LinkStream& stream);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> read_frames(net::LinkStream& stream);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> write_frames(net::LinkStream& stream);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> watch_link();
    [[nodiscard]] wire::LinkError closed(const boost::system::error_code& failed) const;
    [[nodiscard]] wire::LinkError unreadable(const Error& error) const;
    [[nodiscard]] std::optional<wire::LinkError> take(std::string_view body);
    [[nodiscard]] std::optional<Error> reason_to_give_up() const;

    /// Waits until `time` or until the timer is cancelled, which is how the coroutines wake one another.
    [[nodiscard]] static boost::asio::awaitable<void> wait(boost::asio::steady_timer& timer, Clock::time_point time);
    void wake_all();

    boost::asio::io_context& io_;
    UplinkOptions options_;
    Feed& feed_;
    Conversation conversation_;
    Backoff backoff_;
    boost::asio::steady_timer feed_wake_;
    boost::asio::steady_timer write_wake_;
    boost::asio::steady_timer progress_wake_;
    Bell heard_;
    Result<> outcome_;
    std::optional<Error> last_trouble_;
    std::optional<Clock::time_point> stopped_;
};

} // namespace scanloom::robot
