#include "server/http/connection.hpp"

#include "common/net/await_tuple.hpp"
#include "server/http/forwarded.hpp"
#include "server/http/incoming.hpp"
#include "server/http/problem.hpp"
#include "server/http/response.hpp"
#include "server/live/viewed_session.hpp"

#include <boost/asio/dispatch.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/read.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <string_view>
#include <utility>
#include <variant>

namespace scanloom::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;

constexpr std::size_t kReadBytes = 4096;

/// How long a request waits for a session whose server does not answer: 5 s until it counts as dead, and some more.
constexpr std::chrono::seconds kTakeOverMax{10};
constexpr std::chrono::milliseconds kTakeOverPause{250};

std::ptrdiff_t field_count(const Incoming& message) { return std::distance(message.begin(), message.end()); }

std::string_view text_of(const beast::flat_buffer& received) {
    return {static_cast<const char*>(received.data().data()), received.size()};
}

/// Skips an empty line before a request, which some clients send after a body (RFC 9112, 2.2).
/// @return whether there was one
bool skip_empty_line(beast::flat_buffer& received) {
    constexpr std::string_view kEmptyLine = "\r\n";
    if (!text_of(received).starts_with(kEmptyLine)) return false;
    received.consume(kEmptyLine.size());
    return true;
}

} // namespace

Connection::Connection(net::LinkStream stream, std::shared_ptr<const Service> service)
    : stream_(std::move(stream)), deadline_(stream_.get_executor()),
      buffer_(service->config.header_bytes_max + kReadBytes), service_(std::move(service)),
      writer_(stream_, deadline_, wait_, *service_), forwarder_(stream_, writer_, *service_) {
    beast::error_code ignored;
    peer_ = stream_.socket().remote_endpoint(ignored).address().to_string();
    wait_.begin(PeerWait::Clock::now());
}

asio::awaitable<void> Connection::run() {
    // g++ 12 loses `this` if a condition mixes && and co_await, so this file has one co_await per statement.
    beast::error_code ignored;
    stream_.socket().non_blocking(true, ignored);
    deadline_.watch(weak_from_this(), [this] { close(); });
    bool open = co_await shake_hands();
    while (open && !stopping_) {
        wait_.begin(PeerWait::Clock::now());
        open = co_await wait_for_request();
        if (open) open = co_await serve_request();
    }
    wait_.end();
    co_await writer_.finish();
    deadline_.stop();
    close();
}

std::optional<std::chrono::duration<double>> Connection::behind() const noexcept {
    return wait_.behind(PeerWait::Clock::now());
}

void Connection::make_room() {
    wait_.stop_measuring();
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] {
        if (self->wait_.is_waiting()) self->close();
    });
}

void Connection::close() { stream_.close(); }

void Connection::stop() {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] {
        self->stopping_ = true;
        if (self->viewer_) self->viewer_->stop();
        self->forwarder_.stop();
        beast::error_code ignored;
        if (self->idle_) self->stream_.socket().cancel(ignored);
    });
}

void Connection::abort() {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] {
        self->close();
        self->forwarder_.abort();
        if (self->viewer_) self->viewer_->abort();
    });
}

/// @return whether requests can be read.
asio::awaitable<bool> Connection::shake_hands() {
    if (!stream_.is_encrypted()) co_return true;
    idle_ = true; // stopping the server does not wait for a handshake
    deadline_.set_after(service_->config.handshake);
    const auto [failed] = co_await stream_.async_handshake(net::LinkStream::Role::kServer, kAwaitTuple);
    deadline_.clear();
    idle_ = false;
    if (!failed) co_return true;
    spdlog::debug("{}: TLS handshake: {}", peer_, failed.message());
    if (net::is_plain_http(failed)) {
        co_await writer_.write_without_tls(problem(
            Status::bad_request, "this port accepts HTTPS only; use the same address with https:// before it", ""));
    } else if (const auto fault = net::client_fault_of(failed)) {
        service_->api.services().authorizer.note(peer_, *fault);
        writer_.keep_until_read(); // the TLS alert
    }
    co_return false;
}

asio::awaitable<bool> Connection::wait_for_request() {
    bool has_skipped = skip_empty_line(buffer_);
    const auto has_request = [&] { return buffer_.size() > 0 && (has_skipped || text_of(buffer_) != "\r"); };
    if (has_request()) co_return true; // pipelined
    idle_ = true;
    deadline_.set_after(service_->config.idle);
    beast::error_code failed;
    while (!failed && !has_request()) {
        const auto [error, size] = co_await stream_.async_read_some(buffer_.prepare(kReadBytes), kAwaitTuple);
        buffer_.commit(size);
        if (!has_skipped) has_skipped = skip_empty_line(buffer_);
        failed = error;
    }
    deadline_.clear();
    idle_ = false;
    co_return !failed;
}

/// @return whether the connection can take another request.
asio::awaitable<bool> Connection::serve_request() {
    Parser parser;
    parser.header_limit(service_->config.header_bytes_max);
    // refusal_of() applies the limit of the route once it is known.
    parser.body_limit(service_->config.import_bytes_max);
    const auto error = co_await read_header(parser);
    wait_.end();
    if (error) {
        co_await refuse(error);
        co_return false;
    }
    Request request = request_of(parser.get());
    auto routed = service_->api.route(request);
    const auto bytes_max = body_bytes_max(std::get_if<Api::Routed>(&routed), service_->config);
    if (const auto refusal = refusal_of(parser, request, bytes_max, *service_)) {
        co_await writer_.write(*refusal);
        co_return false;
    }
    auto admitted = admit(request, std::move(routed));
    if (!parser.is_done()) {
        if (const auto* refusal = std::get_if<Response>(&admitted)) { // before the body is sent
            co_await writer_.write(*refusal);
            co_return false;
        }
        if (parser.chunked()) parser.body_limit(bytes_max);
        const bool is_read = co_await read_body(parser);
        if (!is_read) co_return false;
    }

    Manner manner{.with_body = parser.get().method() != beast::http::verb::head,
                  .keep_alive = parser.get().keep_alive(),
                  .takes_chunks = parser.get().version() >= 11};
    Incoming message = parser.release();
    read_rest(message, request);
    if (stopping_) manner.keep_alive = false;
    if (const auto* known = std::get_if<Api::Admitted>(&admitted)) {
        const auto passed_on = co_await pass_on(*known, request, message, manner);
        if (passed_on) co_return *passed_on;
    }
    const auto begin = std::chrono::steady_clock::now();
    std::optional<Response> response;
    if (auto* refusal = std::get_if<Response>(&admitted)) {
        response = std::move(*refusal);
    } else {
        response = co_await service_->api.answer(std::get<Api::Admitted>(std::move(admitted)), request);
    }
    service_->counters.request_seconds.observe(std::chrono::steady_clock::now() - begin);
    if (response->viewed) {
        co_await show(*response->viewed, message);
        co_return false;
    }
    if (stopping_) manner.keep_alive = false;
    co_return co_await writer_.write(*response, manner);
}

/// Returns the request without its body, from the client that sent it, perhaps to another server.
Request Connection::request_of(const Incoming& head) const {
    Request request = head_of(head);
    request.peer = peer_;
    request.is_secure = stream_.is_encrypted();
    request.is_of_viewer_page = std::ranges::count(service_->config.viewer_origins, request.origin) > 0;
    const beast::string_view field(kForwardedField.data(), kForwardedField.size());
    if (auto client = parse_forwarded(view(head[field]), service_->api.services().nodes.secret)) {
        request.is_forwarded = true;
        request.peer = std::move(client->peer);
        request.is_secure = client->is_secure;
    }
    return request;
}

/// Passes a request on if another server has the session. If that server has ended, waits until the session is free,
/// and takes it.
/// @return whether the connection can take another request; nullopt: this server answers the request itself
asio::awaitable<std::optional<bool>> Connection::pass_on(const Api::Admitted& admitted, const Request& request,
                                                         const Incoming& message, Manner manner) {
    const auto until = std::chrono::steady_clock::now() + kTakeOverMax;
    asio::steady_timer pause(stream_.get_executor());
    for (;;) {
        const auto owner = co_await service_->api.owner_of(admitted, request);
        if (owner && !*owner) co_return std::nullopt;
        auto outcome = Forwarder::Outcome::kNotThere;
        if (owner) outcome = co_await forwarder_.forward(**owner, request, message, manner);
        if (outcome == Forwarder::Outcome::kAnswered) co_return true;
        if (outcome == Forwarder::Outcome::kClosed) co_return false;
        std::optional<Error> failure;
        if (outcome == Forwarder::Outcome::kInterrupted) {
            failure = {Errc::kUnreachable, fmt::format("server {}, which has the session, did not answer; it is not "
                                                       "known whether it has carried the request out",
                                                       (*owner)->name)};
        } else if (stopping_ || std::chrono::steady_clock::now() > until) {
            failure = owner ? Error{Errc::kNotOwner, fmt::format("server {} has the session and does not answer; try "
                                                                 "again, and another server takes the session over",
                                                                 (*owner)->name)}
                            : owner.error();
        }
        if (failure) co_return co_await writer_.write(problem(*failure, instance_of(request.target)), manner);
        service_->api.services().sessions.forget_owner(admitted.routed.match.arguments["session"]);
        pause.expires_after(kTakeOverPause);
        co_await pause.async_wait(kAwaitTuple);
    }
}

/// Returns the request if its header permits it, or the refusal.
std::variant<Api::Admitted, Response> Connection::admit(const Request& head,
                                                        std::variant<Api::Routed, Response> routed) const {
    if (auto* refusal = std::get_if<Response>(&routed)) return std::move(*refusal);
    return service_->api.admit(head, std::get<Api::Routed>(std::move(routed)));
}

/// Usually the whole header arrives with the first bytes, and no wait is needed.
asio::awaitable<beast::error_code> Connection::read_header(Parser& parser) {
    beast::error_code error;
    buffer_.consume(parser.put(buffer_.data(), error));
    if (error != beast::http::error::need_more) co_return error;
    deadline_.set_after(service_->config.header);
    const auto [failed, size] = co_await beast::http::async_read_header(stream_, buffer_, parser, kAwaitTuple);
    deadline_.clear();
    co_return failed;
}

/// @return false if the connection cannot be used any more
asio::awaitable<bool> Connection::read_body(Parser& parser) {
    if (parser.is_done()) co_return true;
    wait_.begin(PeerWait::Clock::now()); // before the peer is told to send
    if (beast::iequals(parser.get()[beast::http::field::expect], "100-continue")) {
        const bool asked = co_await writer_.write_all("HTTP/1.1 100 Continue\r\n\r\n");
        if (!asked) co_return false;
    }
    const auto& config = service_->config;
    const auto begin = std::chrono::steady_clock::now();
    const auto fields = field_count(parser.get());
    wait_.begin(PeerWait::Clock::now()); // write_all() ends the wait if it had to wait itself
    while (!parser.is_done()) {
        const auto received = static_cast<double>(parser.get().body().size());
        const std::chrono::duration<double> more(received / static_cast<double>(config.read_rate_min));
        wait_.allow(more.count());
        const auto end = begin + config.body + std::chrono::duration_cast<std::chrono::milliseconds>(more);
        deadline_.set(std::min(end, std::chrono::steady_clock::now() + config.body_pause));
        const auto [error, size] = co_await beast::http::async_read_some(stream_, buffer_, parser, kAwaitTuple);
        deadline_.clear();
        if (!error) continue;
        co_await refuse(error);
        co_return false;
    }
    wait_.end();
    if (field_count(parser.get()) == fields) co_return true;
    co_await writer_.write(problem(Status::bad_request,
                                   "fields behind a chunked body are not read; send them before it",
                                   instance_of(head_of(parser.get()).target)));
    co_return false;
}

/// Hands the socket over to a viewer and returns when the viewer ends.
asio::awaitable<void> Connection::show(const live::ViewedSession& viewed, const Incoming& upgrade) {
    const auto path = instance_of(head_of(upgrade).target);
    auto permit = service_->viewers.try_acquire(viewed.session_id);
    std::optional<Response> refusal;
    if (!permit) {
        service_->counters.live.refused.Increment();
        refusal = problem(Error{Errc::kOverloaded, "too many viewers watch at this moment; try again later"}, path);
    } else if (buffer_.size() > 0) {
        refusal =
            problem(Status::bad_request, "a WebSocket client sends nothing before the answer to its upgrade", path);
    }
    if (refusal) {
        co_await writer_.write(*refusal);
        co_return;
    }
    service_->counters.answered(static_cast<unsigned>(Status::switching_protocols)).Increment();
    const auto& executors = service_->api.services().work_classes.executors();
    viewer_ = std::make_shared<live::Viewer>(
        std::move(stream_), viewed, std::move(permit),
        live::Viewer::Services{service_->config.live, executors.live, executors.log_reading, service_->counters.live});
    if (stopping_) viewer_->stop();
    co_await viewer_->run(upgrade);
}

asio::awaitable<void> Connection::refuse(beast::error_code reason) {
    if (is_tls_hello(buffer_)) {
        writer_.keep_until_read(); // the peer cannot read a response without TLS
    } else if (const auto refusal = refusal_of(buffer_, reason)) {
        co_await writer_.write(*refusal);
    }
}

} // namespace scanloom::http
