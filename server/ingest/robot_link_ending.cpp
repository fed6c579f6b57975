#include "common/net/await_tuple.hpp"
#include "server/ingest/robot_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <fmt/format.h>

/// The end of a RobotLink: deadlines, the last message to the robot, and the log line.
namespace scanloom::ingest {
namespace asio = boost::asio;
namespace {

constexpr std::size_t kUnheardBytes = std::size_t{64} << 10; // size of a read whose bytes are discarded

std::string in_http(std::string_view sentence) {
    return fmt::format("HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\n"
                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}\n",
                       sentence.size() + 1, sentence);
}

} // namespace

void RobotLink::end(const Error& error) {
    if (ended_by_) return;
    ended_by_ = error;
    settled_.cancel();
    held_back_.cancel();
    stop_reading_.emit(asio::cancellation_type::terminal); // ends receive(); a running write is completed
}

/// Sends the robot the reason, then ends the connection.
asio::awaitable<void> RobotLink::farewell(wire::LinkError why) {
    ended_by_ = why.error;
    if (!dialogue_.is_welcome() && decoder_.holds_http()) {
        outbox_.send_bytes(in_http(why.error.message)); // an HTTP client cannot read frames
    } else {
        outbox_.send(why);
    }
    co_await part();
}

/// Writes the rest of the outbox, and waits for the robot to close the connection. Closing it at once, with the robot's
/// bytes unread, would reset the connection and lose the last frame.
asio::awaitable<void> RobotLink::part() {
    parting_ = true;
    expect_something_within(config_.farewell_deadline);
    outbox_.close();
    co_await writer_.emptied();
    co_await let_hang_up();
}

/// Waits, within the deadline, until the robot closes the connection, so that it can read the last frame or TLS alert.
asio::awaitable<void> RobotLink::let_hang_up() {
    parting_ = true;
    expect_something_within(config_.farewell_deadline);
    stream_.shutdown_send();
    for (;;) {
        const auto room = decoder_.prepare(kUnheardBytes);
        const auto [failed, bytes] =
            co_await stream_.socket().async_read_some(asio::buffer(room.data(), room.size()), kAwaitTuple);
        if (failed) co_return;
    }
}

void RobotLink::hang_up() {
    deadline_timer_.cancel();
    *is_gone_ = true;
    stream_.close();
}

void RobotLink::start_watch() {
    asio::co_spawn(
        stream_.get_executor(), [self = shared_from_this()] { return self->watch_deadline(); }, asio::detached);
}

void RobotLink::expect_something_within(std::chrono::steady_clock::duration time) {
    deadline_ = std::chrono::steady_clock::now() + time;
    if (deadline_ < deadline_timer_.expiry()) deadline_timer_.cancel(); // earlier than the timer expires
}

/// Ends the link when its deadline has passed. There is one timer per link, checked when it expires: a busy link only
/// moves a time point.
asio::awaitable<void> RobotLink::watch_deadline() {
    const auto self = shared_from_this();
    while (stream_.is_open()) {
        deadline_timer_.expires_at(deadline_);
        co_await deadline_timer_.async_wait(kAwaitTuple);
        if (!stream_.is_open() || std::chrono::steady_clock::now() < deadline_) continue;
        if (ended_by_ || parting_) { // the robot did not close the connection in time
            stream_.close();
            co_return;
        }
        expect_something_within(config_.farewell_deadline);
        end({Errc::kTimeout, dialogue_.is_welcome() ? "nothing was received for too long; send a ping now and then"
                                                    : "no hello was received in time"});
    }
}

void RobotLink::tell_end(std::string_view how, bool was_let_in) const {
    if (was_let_in) return log::info(about(), "{} {}", who_ended(), how);
    const auto untold = services_.audit.take_line_of_stranger();
    if (!untold) return;
    const auto others =
        *untold > 0 ? fmt::format(" ({} others were not let in since the last line like this)", *untold) : "";
    log::info(about(), "{} {}{}", who_ended(), how, others);
}

std::string RobotLink::who_ended() const {
    if (robot_.empty()) return fmt::format("a link from {} that never said a valid hello ended:", peer_);
    return fmt::format("robot '{}' at {} left:", robot_, peer_);
}

log::Context RobotLink::about() const {
    return {dialogue_.is_welcome() ? std::string_view(dialogue_.session()->info().name) : "", robot_, peer_};
}

} // namespace scanloom::ingest
