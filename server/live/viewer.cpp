#include "server/live/viewer.hpp"

#include "common/net/await_tuple.hpp"
#include "common/wire/live.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/field.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
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

websocket::close_reason close_with(websocket::close_code code, std::string_view reason) {
    constexpr std::size_t kReasonBytesMax = 123; // limit of a control frame
    const auto cut = reason.substr(0, kReasonBytesMax);
    return {code, beast::string_view(cut.data(), cut.size())};
}

/// Returns the current state of a session, which must not be deleted.
SessionSnapshot snapshot_of(const sessions::Session& session, std::uint64_t goals_revision) {
    SessionSnapshot snapshot{session.snapshot(), session.connected(), wire::LiveState::kOk, {}, goals_revision};
    const auto closing = session.closing();
    const auto failure = session.failure();
    if (closing || failure) {
        snapshot.state = closing ? wire::LiveState::kDraining : wire::LiveState::kFailed;
        snapshot.reason = closing ? closing->message : failure->message;
    }
    return snapshot;
}

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
      services_(std::move(services)), encoder_(viewed_.tag), turn_(stream_.get_executor()),
      deadline_(stream_.get_executor()) {
    const auto& config = services_.config;
    boost::system::error_code ignored;
    stream_.next_layer().socket().set_option(asio::socket_base::send_buffer_size(config.send_buffer_bytes), ignored);
    stream_.set_option(websocket::stream_base::timeout{config.handshake, config.idle, true});
    stream_.set_option(websocket::stream_base::decorator( // instead of Beast's version
        [](websocket::response_type& response) { response.set(beast::http::field::server, "Scanloom"); }));
    stream_.read_message_max(config.request_bytes_max);
    stream_.auto_fragment(false);
    stream_.binary(true);
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
        co_await send_events();
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
    const auto [error] = co_await stream_.async_accept(upgrade, kAwaitTuple);
    co_return !error;
}

/// Ends when the client disconnects, sends an invalid message, or the connection is closed.
asio::awaitable<void> Viewer::read_requests() {
    const auto self = shared_from_this();
    for (;;) {
        buffer_.clear();
        const auto [error, size] = co_await stream_.async_read(buffer_, kAwaitTuple);
        if (error) co_return;
        if (auto fault = fault_of_message()) {
            end(*fault);
            co_return;
        }
        changed_ = true;
        wake();
    }
}

/// Handles the message in buffer_. @return the reason to close the connection, if the message is invalid
std::optional<Viewer::Close> Viewer::fault_of_message() {
    if (!stream_.got_binary()) {
        return close_with(websocket::close_code::unknown_data,
                          "a text message was received; send a binary LiveRequest (live.proto)");
    }
    const auto bytes = buffer_.data();
    const auto request = wire::decode_live_request({static_cast<const char*>(bytes.data()), bytes.size()});
    if (!request) return close_with(websocket::close_code::bad_payload, request.error().message);
    subscription_ = subscription_of(*request);
    return std::nullopt;
}

asio::awaitable<void> Viewer::send_events() {
    for (;;) {
        co_await wait_for_turn();
        if (ending_ || !reading_) co_return;
        changed_ = false;
        if (subscription_) encoder_.set_subscription(*std::exchange(subscription_, std::nullopt));
        auto work = [self = shared_from_this()] { return self->next_step(); };
        const NextStep step = co_await sockets::compute_on(services_.showing, std::move(work));
        look_again_ = step.look_again;
        if (step.end) end(*step.end);
        if (!step.event) continue;
        due_ = Clock::now() + services_.config.interval;
        const bool sent = co_await send(*step.event);
        if (!sent) co_return;
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

/// Creates the next event. Runs on `showing`.
Viewer::NextStep Viewer::next_step() {
    notified_ = false; // before reading the state, so that later changes notify again
    if (viewed_.credential && !viewed_.credential->token()) {
        viewed_.on_revoked();
        return {{}, close_with(kTokenGone, "your token is no longer valid for this session; sign in with another"), {}};
    }
    const auto session = viewed_.session.lock();
    const auto closing = session ? session->closing() : std::nullopt;
    const bool is_deleted = closing ? closing->code == Errc::kGone : !session && !viewed_.is_stored();
    if (is_deleted) {
        return {{}, close_with(kSessionDeleted, fmt::format("session '{}' was deleted", viewed_.name)), {}};
    }
    if (!session)
        return {{},
                close_with(websocket::close_code::going_away, "the session was evicted from memory; connect again"),
                {}};
    const auto paths = viewed_.paths.state(session, Clock::now());
    SessionSnapshot snapshot = snapshot_of(*session, paths.revision);
    const auto until = std::min(paths.until, add_landmarks(session, snapshot));
    const auto event = encoder_.next(snapshot);
    std::optional<Close> end;
    if (closing) end = close_with(websocket::close_code::going_away, closing->message);
    if (!event) return {{}, end, until};
    return {wire::encode(*event), end, encoder_.has_more() ? Clock::now() : until};
}

/// @return when to look for landmarks again
Viewer::Clock::time_point Viewer::add_landmarks(const std::shared_ptr<const sessions::Session>& session,
                                                SessionSnapshot& snapshot) {
    if (!encoder_.subscribes_to_landmarks()) return Clock::time_point::max();
    const LandmarkSearch search{services_.finding, services_.config.landmarks_pause, services_.config.landmarks_turn};
    auto look = viewed_.landmarks->look(session, snapshot.maps->revision, search);
    snapshot.landmarks = std::move(look.found);
    return look.until;
}

/// @return false if the connection is no longer usable
asio::awaitable<bool> Viewer::send(const std::string& event) {
    if (!ending_) cut_off_after(services_.config.write);
    const auto [error, size] = co_await stream_.async_write(asio::buffer(event), kAwaitTuple);
    if (!ending_) deadline_.cancel();
    if (error) co_return false;
    services_.counters.events.Increment();
    services_.counters.bytes.Increment(static_cast<double>(size));
    co_return true;
}

asio::awaitable<void> Viewer::close() {
    if (ending_ && stream_.is_open()) co_await stream_.async_close(*ending_, kAwaitTuple);
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
