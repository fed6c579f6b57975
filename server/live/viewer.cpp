#include "server/live/viewer.hpp"

#include "common/net/await_tuple.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/field.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <string_view>
#include <utility>

namespace scanloom::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;

/// Private close codes (RFC 6455, section 7.4.2), named after the HTTP status codes 401 and 404.
constexpr websocket::close_code kTokenGone{4401};
constexpr websocket::close_code kSessionDeleted{4404};

/// Increments a gauge while it exists.
class Counted {
public:
    explicit Counted(prometheus::Gauge& gauge) : gauge_(gauge) { gauge_.Increment(); }
    ~Counted() { gauge_.Decrement(); }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;

private:
    prometheus::Gauge& gauge_;
};

} // namespace

Viewer::Viewer(net::LinkStream stream, ViewedSession viewed, limits::Semaphore::Permit permit, Services services)
    : stream_(std::move(stream)), viewed_(std::move(viewed)), permit_(std::move(permit)),
      services_(std::move(services)), dialogue_(make_dialogue(viewed_, {services_.config, services_.finding})),
      turn_(stream_.get_executor()), deadline_(stream_.get_executor()) {
    const auto& config = services_.config;
    boost::system::error_code ignored;
    stream_.next_layer().socket().set_option(asio::socket_base::send_buffer_size(config.send_buffer_bytes), ignored);
    stream_.set_option(websocket::stream_base::timeout{config.handshake, config.idle, true});
    const auto decorate = [protocol = viewed_.subprotocol](websocket::response_type& response) {
        response.set(beast::http::field::server, "Scanloom"); // instead of Beast's version
        if (!protocol.empty()) response.set(beast::http::field::sec_websocket_protocol, protocol);
    };
    stream_.set_option(websocket::stream_base::decorator(decorate));
    stream_.read_message_max(config.request_bytes_max);
    stream_.auto_fragment(false);
}

// On any thread

void Viewer::on_changed() noexcept {
    if (notified_.exchange(true)) return;
    try {
        asio::post(stream_.get_executor(), [weak = weak_from_this()] {
            if (const auto self = weak.lock()) {
                self->changed_ = true;
                self->wake();
            }
        });
    } catch (...) { // std::bad_alloc: the next change tries again
        notified_ = false;
    }
}

void Viewer::stop() {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] {
        self->end(close_with(websocket::close_code::going_away,
                             "the server is shutting down; connect again when it is back"));
    });
}

void Viewer::abort() {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] { self->stream_.next_layer().close(); });
}

// On the strand

asio::awaitable<void> Viewer::run(const Upgrade& upgrade) {
    const bool accepted = co_await accept(upgrade);
    if (!accepted) co_return;
    const Counted counted(services_.counters.viewers);
    if (const auto session = viewed_.session.lock()) session->watch(weak_from_this());
    if (viewed_.credential) {
        viewed_.credential->when_changed([weak = weak_from_this()] {
            if (const auto self = weak.lock()) self->on_changed();
        });
    }
    reading_ = true;
    asio::co_spawn(stream_.get_executor(), read_requests(), [self = shared_from_this()](std::exception_ptr) {
        self->reading_ = false;
        self->wake();
    });
    try {
        co_await send_turns();
    } catch (const std::exception& failure) {
        spdlog::error("a viewer's connection failed and was closed: {}", failure.what());
        end(close_with(websocket::close_code::internal_error, "internal error; see the server's log"));
    }
    co_await close();
    while (reading_) {
        turn_.expires_at(Clock::time_point::max());
        co_await turn_.async_wait(kAwaitTuple);
    }
}

asio::awaitable<bool> Viewer::accept(const Upgrade& upgrade) {
    const auto error = co_await net::accept(stream_, upgrade);
    co_return !error;
}

/// Ends when the client disconnects or the connection is closed.
asio::awaitable<void> Viewer::read_requests() {
    const auto self = shared_from_this();
    for (;;) {
        buffer_.clear();
        const auto error = co_await net::read(stream_, buffer_);
        if (error) co_return;
        keep_message();
    }
}

/// Keeps the message in buffer_ for the next turn.
void Viewer::keep_message() {
    constexpr std::size_t kOverhead = 64; // bytes of an empty message
    const auto bytes = buffer_.data();
    received_bytes_ += bytes.size() + kOverhead;
    if (received_bytes_ > kReceivedBytesMax) {
        return end(close_with(websocket::close_code::policy_error, "too many messages at once; send fewer"));
    }
    received_.push_back(
        {.bytes = std::string(static_cast<const char*>(bytes.data()), bytes.size()), .is_text = stream_.got_text()});
    changed_ = true;
    wake();
}

asio::awaitable<void> Viewer::send_turns() {
    for (;;) {
        co_await wait_for_turn();
        if (ending_ || !reading_) co_return;
        changed_ = false;
        received_bytes_ = 0;
        auto work = [self = shared_from_this(), received = std::exchange(received_, {})] {
            return self->next_step(received);
        };
        const NextStep step = co_await sockets::compute_on(services_.showing, std::move(work));
        look_again_ = step.turn.look_again;
        if (step.end) end(*step.end);
        if (step.turn.messages.empty()) continue;
        due_ = Clock::now() + services_.config.interval;
        if (!ending_) cut_off_after(services_.config.write);
        for (const ViewerMessage& message : step.turn.messages) {
            const bool sent = co_await send(message);
            if (!sent) co_return;
        }
        if (!ending_) deadline_.cancel();
    }
}

/// Waits until the state may have changed and the interval is over, or until the connection ends.
asio::awaitable<void> Viewer::wait_for_turn() {
    while (!ending_ && reading_) {
        changed_ = changed_ || Clock::now() >= look_again_;
        if (changed_ && Clock::now() >= due_) co_return;
        turn_.expires_at(changed_ ? due_ : look_again_);
        co_await turn_.async_wait(kAwaitTuple);
    }
}

/// Handles what the viewer sent, and creates the next messages. Runs on `showing`.
Viewer::NextStep Viewer::next_step(const std::vector<ViewerMessage>& received) {
    notified_ = false; // before reading the state, so that later changes notify again
    if (viewed_.credential && !viewed_.credential->token()) {
        viewed_.on_revoked();
        return {{}, close_with(kTokenGone, "your token is no longer valid for this session; sign in with another")};
    }
    const auto session = viewed_.session.lock();
    const auto closing = session ? session->closing() : std::nullopt;
    const bool is_deleted = closing ? closing->code == Errc::kGone : !session && !viewed_.is_stored();
    if (is_deleted) return {{}, close_with(kSessionDeleted, fmt::format("session '{}' was deleted", viewed_.name))};
    if (!session) {
        return {{},
                close_with(websocket::close_code::going_away, "the session was evicted from memory; connect again")};
    }
    for (const ViewerMessage& message : received) {
        if (auto fault = dialogue_->receive(message)) return {{}, std::move(fault)};
    }
    std::optional<Close> end;
    if (closing) end = close_with(websocket::close_code::going_away, closing->message);
    return {dialogue_->next(session, Clock::now()), end};
}

/// @return false if the connection is no longer usable
asio::awaitable<bool> Viewer::send(const ViewerMessage& message) {
    stream_.text(message.is_text);
    const std::array parts{asio::buffer(message.bytes),
                           message.rest ? asio::buffer(*message.rest) : asio::const_buffer()};
    const auto error = co_await net::write(stream_, parts);
    if (error) co_return false;
    services_.counters.events.Increment();
    services_.counters.bytes.Increment(static_cast<double>(asio::buffer_size(parts)));
    co_return true;
}

asio::awaitable<void> Viewer::close() {
    if (ending_ && stream_.is_open()) static_cast<void>(co_await net::close(stream_, *ending_));
    deadline_.cancel();
    stream_.next_layer().close(); // also ends a pending read
}

void Viewer::end(Close why) {
    if (ending_) return;
    ending_ = std::move(why);
    cut_off_after(services_.config.farewell);
    wake();
}

void Viewer::wake() { turn_.cancel(); }

void Viewer::cut_off_after(std::chrono::milliseconds time) {
    deadline_.expires_after(time);
    deadline_.async_wait([weak = weak_from_this()](boost::system::error_code cancelled) {
        const auto self = weak.lock();
        if (!cancelled && self) self->stream_.next_layer().close();
    });
}

} // namespace scanloom::live
