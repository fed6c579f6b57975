#pragma once

#include "robot_client/source/source.hpp"
#include "robot_client/uplink/backoff.hpp"
#include "robot_client/uplink/conversation.hpp"
#include "robot_client/uplink/pacer.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A pause between two scans that people are told of.
inline constexpr std::chrono::seconds kLongPause{60};

struct UplinkOptions {
    std::string host;
    std::string port;
    ConversationOptions conversation;
    double speed = 0.0; ///< of the source's own pace; 0 = as fast as the server takes it
    std::chrono::milliseconds connect_timeout{10'000};
    std::chrono::milliseconds give_up_after{120'000}; ///< without progress; 0 = never
    std::chrono::milliseconds drain_max{10'000};      ///< how long stop() waits for acknowledgements
    std::uint32_t backoff_seed = 1;
    /// Hears of every link that failed and is going to be replaced.
    std::function<void(const Error&)> on_trouble = [](const Error&) {};
    /// Hears, before the first scan is sent, how many the server holds from earlier runs; only if there are any.
    std::function<void(std::uint64_t)> on_resume = [](std::uint64_t) {};
    /// Hears how long nothing will be sent, when the next scan is due in more than kLongPause only.
    std::function<void(std::chrono::duration<double>)> on_long_pause = [](std::chrono::duration<double>) {};
};

/// How far an uplink is, for people and for the summary.
struct UplinkStatus {
    std::uint64_t resumed_after = 0; ///< scans the server held from earlier runs
    std::uint64_t last = 0;          ///< highest seq taken from the source, or resumed_after
    std::uint64_t acknowledged = 0;  ///< highest durable seq
    std::uint64_t sent = 0;          ///< scans that went out in this run, each counted once
    std::uint64_t bytes = 0;         ///< sent, resent ones included
    std::uint64_t reconnects = 0;
    bool is_linked = false;
    std::optional<std::chrono::duration<double>> next_scan_in = {}; ///< only in a long pause
};

/// Carries a source's scans to the server: connects, reconnects, keeps the pace. The protocol is Conversation's;
/// here are the sockets and timers.
///
/// Thread  everything runs on the one thread of `io`; stop() and ask() are called on it, too.
class Uplink {
public:
    Uplink(boost::asio::io_context& io, UplinkOptions options, Source& source);

    /// Completes when every scan is durable. Those the server holds from earlier runs are passed over.
    /// Errors  the server's, if it is final; kTimeout when nothing moves for give_up_after or not all sent scans
    ///         were acknowledged within drain_max of stop(); those of outcome_when_interrupted(); kConflict when the
    ///         server holds more scans than the source has; those of the source.
    [[nodiscard]] boost::asio::awaitable<Result<>> run();

    /// No more scans from the source; run() completes once those taken are durable, or after drain_max.
    void stop();

    /// What it comes to when it is left now, after stop().
    /// Errors  kShuttingDown: scans were sent and not acknowledged, or the source has an end and is not there yet.
    [[nodiscard]] Result<> outcome_when_interrupted() const;

    /// Conversation::ask(), sent as soon as there is a link. `answered` is called on the thread of `io`.
    [[nodiscard]] bool ask(Request request, Answered answered);

    [[nodiscard]] UplinkStatus status() const;

private:
    using Clock = std::chrono::steady_clock;
    using Socket = boost::asio::ip::tcp::socket;

    [[nodiscard]] boost::asio::awaitable<void> feed();
    [[nodiscard]] boost::asio::awaitable<Result<>> pass_over(std::uint64_t scans);
    [[nodiscard]] boost::asio::awaitable<Result<>> feed_scans();
    [[nodiscard]] boost::asio::awaitable<void> wait_until_due(Clock::time_point due);
    [[nodiscard]] boost::asio::awaitable<void> keep_linked();
    [[nodiscard]] boost::asio::awaitable<void> watch_progress();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> use_one_link();
    [[nodiscard]] boost::asio::awaitable<std::optional<wire::LinkError>> connect(Socket& socket);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> read_frames(Socket& socket);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> write_frames(Socket& socket);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> watch_link();
    [[nodiscard]] wire::LinkError unreadable(const Error& error) const;
    [[nodiscard]] std::optional<wire::LinkError> take(std::string_view body);
    [[nodiscard]] std::optional<Error> reason_to_give_up() const;
    [[nodiscard]] std::string what_is_wrong() const;

    /// Waits until `time` or until the timer is cancelled, which is how the coroutines wake one another.
    [[nodiscard]] static boost::asio::awaitable<void> wait(boost::asio::steady_timer& timer, Clock::time_point time);
    void wake_all();

    boost::asio::io_context& io_;
    UplinkOptions options_;
    Source& source_;
    Conversation conversation_;
    Pacer pacer_;
    Backoff backoff_;
    boost::asio::steady_timer feed_wake_;
    boost::asio::steady_timer write_wake_;
    boost::asio::steady_timer progress_wake_;
    Result<> outcome_;
    std::optional<Error> last_trouble_;
    std::optional<Clock::time_point> stopped_;
    std::optional<Clock::time_point> pause_ends_; ///< of a long pause
    bool source_ended_ = false;
};

} // namespace scanloom::robot
