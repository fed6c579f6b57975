#include "robot_client/uplink/uplink.hpp"

#include "common/error/error.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

constexpr std::size_t kReadBytes = 16384;
constexpr std::chrono::milliseconds kProgressPeriod{100};
constexpr std::chrono::milliseconds kGoodbyeMax{1000};

wire::LinkError lost(std::string message) { return {{Errc::kUnreachable, std::move(message)}, true}; }

} // namespace

Uplink::Uplink(asio::io_context& io, UplinkOptions options, Feed& feed)
    : io_(io), options_(std::move(options)), feed_(feed), buffer_(options_.buffer_bytes_max),
      protocol_(options_.protocol, buffer_, Clock::now()), servers_(options_.servers, options_.protocol.hello.session),
      backoff_(options_.backoff_seed, options_.backoff), feed_wake_(io), write_wake_(io), progress_wake_(io) {}

asio::awaitable<Result<>> Uplink::run() {
    co_await (keep_linked() || take_from_feed() || watch_progress());
    const bool is_cut_short = outcome_ && stopped_;
    co_return is_cut_short ? outcome_when_interrupted() : outcome_;
}

Result<> Uplink::outcome_when_interrupted() const {
    const auto interrupted = [](const std::string& what) { return Error{Errc::kShuttingDown, "interrupted " + what}; };
    if (!protocol_.resumed_after()) {
        const std::string spooled =
            feed_.waiting() > 0 ? fmt::format(" with {} scans in the spool", feed_.waiting()) : std::string();
        return interrupted(fmt::format("before the server answered{}: {}", spooled, what_is_wrong()));
    }
    if (const std::uint64_t missing = buffer_.last() - buffer_.acknowledged(); missing > 0) {
        return interrupted(fmt::format("before {} scans were acknowledged", missing));
    }
    if (const auto why = feed_.unfinished(buffer_.last())) return interrupted(*why);
    return {};
}

void Uplink::stop() {
    if (!stopped_) stopped_ = Clock::now();
    wake_all();
}

std::optional<std::uint64_t> Uplink::ask(link::Request request, link::Answered answered) {
    const auto id = protocol_.ask(std::move(request), std::move(answered));
    if (id) write_wake_.cancel();
    return id;
}

UplinkStatus Uplink::status() const {
    const std::uint64_t welcomes = protocol_.welcomes();
    return {protocol_.resumed_after().value_or(0),
            buffer_.last(),
            buffer_.acknowledged(),
            buffer_.sent_ever() - protocol_.resumed_after().value_or(0),
            protocol_.bytes_sent(),
            welcomes > 0 ? welcomes - 1 : 0,
            feed_.waiting(),
            feed_.dropped(),
            protocol_.is_welcome(),
            feed_.next_scan_in()};
}

// The feed ------------------------------------------------------------------------------------------------------------

asio::awaitable<void> Uplink::take_from_feed() {
    const Result<> fed = co_await feed_.run(*this);
    const auto cancellation = co_await asio::this_coro::cancellation_state;
    if (cancellation.cancelled() != asio::cancellation_type::none) co_return; // the outcome is already set
    if (!fed) outcome_ = fed.error();
    if (!fed && buffer_.acknowledged() == buffer_.last()) co_return;
    protocol_.end();
    wake_all();
    for (;;) co_await wait(feed_wake_, Clock::time_point::max()); // the other coroutines end the run
}

void Uplink::add(Observation observation) {
    buffer_.push(std::move(observation));
    protocol_.on_scans_added(1, Clock::now());
    write_wake_.cancel();
}

asio::awaitable<void> Uplink::until_applied() {
    const auto all_handed_over = [&] { return protocol_.resumed_after() && feed_.waiting() == 0; };
    while (!all_handed_over()) co_await changed_.wait(Clock::now() + kProgressPeriod);
    const std::uint64_t last = buffer_.last();
    while (protocol_.applied() < last) co_await changed_.wait();
}

// Progress ------------------------------------------------------------------------------------------------------------

asio::awaitable<void> Uplink::watch_progress() {
    std::optional<Clock::time_point> done_since;
    for (;;) {
        const auto now = Clock::now();
        if (protocol_.is_done()) {
            if (!done_since) done_since = now;
            if (!protocol_.is_welcome() || now > *done_since + kGoodbyeMax) co_return;
        } else if (auto reason = reason_to_give_up()) {
            outcome_ = *reason;
            co_return;
        }
        co_await wait(progress_wake_, now + kProgressPeriod);
    }
}

std::optional<Error> Uplink::reason_to_give_up() const {
    const auto now = Clock::now();
    if (stopped_ && !protocol_.resumed_after()) return outcome_when_interrupted().error();
    if (stopped_ && now > *stopped_ + options_.drain_max) {
        return Error{Errc::kTimeout, fmt::format("interrupted; {} scans were not acknowledged within {:g} s: {}",
                                                 buffer_.last() - buffer_.acknowledged(), seconds(options_.drain_max),
                                                 what_is_wrong())};
    }
    const auto since = protocol_.stalled_since();
    const auto timeout = feed_.has_ended() ? options_.give_up_after_end : options_.give_up_after;
    if (since && timeout.count() > 0 && now > *since + timeout) {
        return Error{Errc::kTimeout,
                     fmt::format("gave up after {:g} s without progress: {}", seconds(timeout), what_is_wrong())};
    }
    return std::nullopt;
}

std::string Uplink::what_is_wrong() const {
    if (protocol_.is_welcome()) {
        return "the server is connected but acknowledges nothing" +
               (last_trouble_ ? fmt::format(" (before this link: {})", last_trouble_->message) : std::string());
    }
    if (last_trouble_) return last_trouble_->message;
    return fmt::format("no answer from {} yet", servers_.current().text());
}

// Links ---------------------------------------------------------------------------------------------------------------

asio::awaitable<void> Uplink::keep_linked() {
    asio::steady_timer pause(io_);
    for (;;) {
        const wire::LinkError failure = co_await use_one_link();
        const auto cancellation = co_await asio::this_coro::cancellation_state;
        if (cancellation.cancelled() != asio::cancellation_type::none) co_return; // the outcome is already set
        protocol_.close();
        changed_.notify();
        if (protocol_.is_done()) co_return;
        if (!failure.retryable) {
            outcome_ = failure.error;
            co_return;
        }
        last_trouble_ = failure.error;
        if (servers_.choose_another(failure.address)) continue; // at once
        options_.on_trouble(failure.error);
        co_await wait(pause, Clock::now() + std::min<Clock::duration>(backoff_.next(), servers_.wait_max()));
    }
}

asio::awaitable<wire::LinkError> Uplink::use_one_link() {
    net::LinkStream stream = net::client_stream(io_.get_executor(), options_.tls);
    const auto timeout = servers_.connect_max(options_.connect_timeout);
    const auto connected = co_await net::connect(stream, servers_.current(), timeout);
    if (!connected) co_return wire::LinkError{connected.error(), true};
    if (const auto time = servers_.unconfirmed_max()) net::set_unconfirmed_max(stream, *time);
    protocol_.open(servers_.current().text(), Clock::now(), servers_.has_others());
    const auto ended = co_await (read_frames(stream) || write_frames(stream) || watch_link());
    co_return std::visit([](const wire::LinkError& failure) { return failure; }, ended);
}

asio::awaitable<wire::LinkError> Uplink::read_frames(net::LinkStream& stream) {
    for (;;) {
        const auto room = protocol_.prepare(kReadBytes);
        const auto [failed, count] =
            co_await stream.async_read_some(asio::buffer(room.data(), room.size()), kAwaitTuple);
        if (failed) co_return closed(stream, failed);
        if (auto failure = take(count)) co_return *failure;
    }
}

wire::LinkError Uplink::closed(const net::LinkStream& stream, const boost::system::error_code& failed) const {
    if (net::is_refused_certificate(failed)) {
        return lost(
            fmt::format("no encrypted link to {}: {}", servers_.current().text(), failure_text(stream, failed)));
    }
    if (protocol_.is_welcome() || options_.tls || failed != asio::error::eof) {
        return lost(fmt::format("the connection was lost: {}", failed.message()));
    }
    return lost(fmt::format("{} closed the connection without an answer; if the server requires TLS, add --tls",
                            servers_.current().text()));
}

std::optional<wire::LinkError> Uplink::take(std::size_t bytes) {
    const std::uint64_t acknowledged_before = buffer_.acknowledged();
    auto failure = protocol_.on_bytes(bytes, Clock::now());
    if (protocol_.is_welcome()) servers_.settle();
    if (buffer_.acknowledged() > acknowledged_before) {
        backoff_.reset();
        last_trouble_.reset();
        feed_.acknowledged(buffer_.acknowledged());
    }
    wake_all();
    return failure;
}

asio::awaitable<wire::LinkError> Uplink::write_frames(net::LinkStream& stream) {
    std::string frame;
    for (;;) {
        while (protocol_.append_next_frame(frame, Clock::now())) {
            const auto [failed, count] = co_await asio::async_write(stream, asio::buffer(frame), kAwaitTuple);
            if (failed) co_return lost(fmt::format("the connection was lost: {}", failed.message()));
            frame.clear();
        }
        if (protocol_.said_goodbye()) stream.shutdown_send(); // then the reader reports how the link ends
        if (auto failure = protocol_.check(Clock::now())) co_return *failure;
        co_await wait(write_wake_, protocol_.deadline(Clock::now()));
    }
}

/// Detects a dead link even while a write to it blocks.
asio::awaitable<wire::LinkError> Uplink::watch_link() {
    asio::steady_timer timer(io_);
    for (;;) {
        if (auto failure = protocol_.check(Clock::now())) co_return *failure;
        co_await wait(timer, Clock::now() + kProgressPeriod);
    }
}

asio::awaitable<void> Uplink::wait(asio::steady_timer& timer, Clock::time_point time) {
    timer.expires_at(time);
    co_await timer.async_wait(kAwaitTuple);
}

std::function<void(const Error&)> report_once(std::function<void(const std::string&)> on_message) {
    return [on_message = std::move(on_message), reported = std::string()](const Error& error) mutable {
        if (error.message == std::exchange(reported, error.message)) return;
        on_message(further(error.message, "trying again"));
    };
}

void Uplink::wake_all() {
    feed_wake_.cancel();
    write_wake_.cancel();
    progress_wake_.cancel();
    changed_.notify();
}

} // namespace scanloom::robot
