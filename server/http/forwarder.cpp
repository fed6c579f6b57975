#include "server/http/forwarder.hpp"

#include "common/net/await_tuple.hpp"
#include "common/net/connect.hpp"
#include "server/http/api.hpp"
#include "server/http/forwarded.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using beast::http::field;

constexpr std::chrono::milliseconds kConnectMax{1'500};
constexpr std::chrono::minutes kAnswerMax{30}; // some answers take minutes
constexpr std::chrono::seconds kLookEvery{2};  // whether the server is dead; the list of servers is a second old
constexpr std::chrono::milliseconds kPieceMax{60'000};
constexpr std::size_t kForwardedPieceBytes = std::size_t{64} << 10;

bool is_repeatable(const Request& request) { return request.method == "GET" || request.method == "HEAD"; }

/// Returns whether a field is about the connection that it was received on.
bool is_of_connection(field name) {
    return name == field::connection || name == field::keep_alive || name == field::transfer_encoding ||
           name == field::content_length || name == field::expect || name == field::te || name == field::trailer;
}

std::string request_head(const Request& request, const Incoming& message, const Manner& manner,
                         std::string_view secret) {
    auto head = fmt::format("{} {} HTTP/1.{}\r\n", request.method, request.target, manner.takes_chunks ? 1 : 0);
    for (const auto& one : message) {
        if (is_of_connection(one.name()) || beast::iequals(one.name_string(), kForwardedField)) continue;
        head += fmt::format("{}: {}\r\n", view(one.name_string()), view(one.value()));
    }
    head += fmt::format("{}: {}\r\n", kForwardedField, forwarded_text({request.peer, request.is_secure}, secret));
    head += request.upgrade ? "Connection: Upgrade\r\n" : "Connection: keep-alive\r\n";
    if (!request.body.empty() || !is_repeatable(request)) {
        head += fmt::format("Content-Length: {}\r\n", request.body.size());
    }
    return head + "\r\n";
}

template <class Parser>
std::string response_head(const Parser& parser, bool is_kept) {
    const auto& answer = parser.get();
    auto head = fmt::format("HTTP/1.1 {} {}\r\n", answer.result_int(), view(answer.reason()));
    const bool is_socket = answer.result() == Status::switching_protocols;
    for (const auto& one : answer) {
        const bool is_left_out = one.name() == field::connection || one.name() == field::keep_alive;
        if (is_socket || !is_left_out) {
            head += fmt::format("{}: {}\r\n", view(one.name_string()), view(one.value()));
        }
    }
    if (!is_socket && !is_kept) head += "Connection: close\r\n";
    return head + "\r\n";
}

/// Lets the system notice within half a minute that the other machine is gone.
void keep_alive(net::LinkStream::Socket& socket) {
    const std::array<std::pair<int, int>, 2> kTimes = {{{TCP_KEEPIDLE, 10}, {TCP_KEEPINTVL, 5}}}; // seconds
    const int on = 1;
    ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    for (const auto& [option, seconds] : kTimes) {
        ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &seconds, sizeof seconds);
    }
}

/// Passes bytes on until one side ends.
/// @param pause_max  longest time without the receiver's taking any
asio::awaitable<void> pass_bytes(net::LinkStream& from, net::LinkStream& to, std::chrono::milliseconds pause_max) {
    std::array<char, 16'384> bytes;
    for (;;) {
        const auto [ended, count] = co_await from.async_read_some(asio::buffer(bytes), kAwaitTuple);
        if (ended) co_return;
        const auto written =
            co_await net::within(pause_max, asio::async_write(to, asio::buffer(bytes.data(), count), kAwaitTuple));
        if (!written || std::get<0>(*written)) co_return;
    }
}

} // namespace

asio::awaitable<Forwarder::Outcome> Forwarder::forward(const store::NodeInfo& owner, const Request& request,
                                                       const Incoming& message, Manner manner) {
    using namespace asio::experimental::awaitable_operators;
    std::exception_ptr failure; // `||` would wait for the other one after an exception
    const auto exchanged = [&]() -> asio::awaitable<Outcome> {
        try {
            co_return co_await exchange(owner, request, message, manner);
        } catch (...) {
            failure = std::current_exception();
        }
        co_return Outcome::kClosed;
    };
    const auto first = co_await (exchanged() || close_if_dead(owner));
    if (failure) std::rethrow_exception(failure);
    co_return std::get<0>(first);
}

/// Closes the connection to a server that counts as dead, as when it is paused. Never ends by itself.
asio::awaitable<void> Forwarder::close_if_dead(const store::NodeInfo& owner) {
    asio::steady_timer look(client_.get_executor());
    for (;;) {
        look.expires_after(kLookEvery);
        co_await look.async_wait(kAwaitTuple);
        if (service_.api.services().sessions.is_dead(owner) && server_) server_->close();
    }
}

asio::awaitable<Forwarder::Outcome> Forwarder::exchange(const store::NodeInfo& owner, const Request& request,
                                                        const Incoming& message, Manner manner) {
    const auto head = request_head(request, message, manner, service_.api.services().nodes.secret);
    const bool can_repeat = is_repeatable(request) && !request.upgrade;
    for (bool is_reused = can_repeat && server_ && place_ == owner.http;; is_reused = false) {
        if (!is_reused) {
            const bool connected = co_await connect(owner.http);
            if (!connected) co_return Outcome::kNotThere;
        }
        Parser parser;
        parser.body_limit(boost::none);
        parser.skip(request.method == "HEAD");
        const bool answered = co_await ask(head, request.body, parser);
        if (answered) co_return co_await answer(parser, manner);
        server_.reset();
        if (!is_reused) co_return can_repeat ? Outcome::kNotThere : Outcome::kInterrupted;
    }
}

void Forwarder::stop() {
    stopped_ = true;
    if (passes_socket_) abort();
}

/// Only the coroutine that uses the connection destroys it.
void Forwarder::abort() {
    stopped_ = true;
    if (server_) server_->close();
}

asio::awaitable<bool> Forwarder::connect(const std::string& place) {
    server_.reset();
    buffer_.clear();
    const auto url = boost::urls::parse_absolute_uri(place);
    if (!url) co_return false; // the server has not announced its address yet
    const bool is_encrypted = url->scheme_id() == boost::urls::scheme::https;
    const net::Address address{url->host_address(), url->port()};
    server_.emplace(net::client_stream(client_.get_executor(),
                                       is_encrypted ? service_.api.services().nodes.tls : net::TlsContext()));
    place_ = place;
    const auto connected = co_await net::connect(*server_, address, kConnectMax);
    if (!connected || stopped_) {
        server_.reset();
        co_return false;
    }
    keep_alive(server_->socket());
    co_return true;
}

/// Sends a request and reads the head of the response.
asio::awaitable<bool> Forwarder::ask(const std::string& head, const std::string& body, Parser& parser) {
    const std::array<asio::const_buffer, 2> whole = {asio::buffer(head), asio::buffer(body)};
    const auto sent = co_await net::within(kPieceMax, asio::async_write(*server_, whole, kAwaitTuple));
    if (!sent || std::get<0>(*sent)) co_return false;
    const auto read =
        co_await net::within(kAnswerMax, beast::http::async_read_header(*server_, buffer_, parser, kAwaitTuple));
    co_return read && !std::get<0>(*read);
}

/// Passes a response on to the client.
asio::awaitable<Forwarder::Outcome> Forwarder::answer(Parser& parser, const Manner& manner) {
    if (parser.get().result() == Status::misdirected_request) {
        server_.reset();
        co_return Outcome::kNotThere;
    }
    service_.counters.answered(parser.get().result_int()).Increment();
    const bool is_socket = parser.get().result() == Status::switching_protocols;
    const bool is_kept = manner.keep_alive && manner.takes_chunks && !parser.need_eof();
    const bool is_server_kept = parser.keep_alive();
    bool written = co_await writer_.write_all(response_head(parser, is_kept));
    if (written && is_socket) co_await pass_socket();
    if (is_socket) co_return Outcome::kClosed;
    if (written) written = co_await pass_body(parser);
    if (!written || !is_server_kept) server_.reset();
    if (written && !is_kept) writer_.keep_until_read();
    co_return written&& is_kept ? Outcome::kAnswered : Outcome::kClosed;
}

/// @return false if the body could not be passed on to its end
asio::awaitable<bool> Forwarder::pass_body(Parser& parser) {
    if (parser.is_done()) co_return true; // no body, as after HEAD
    const bool is_chunked = parser.chunked();
    std::string piece(kForwardedPieceBytes, '\0');
    while (!parser.is_done()) {
        auto& body = parser.get().body();
        body.data = piece.data();
        body.size = piece.size();
        const auto read =
            co_await net::within(kPieceMax, beast::http::async_read_some(*server_, buffer_, parser, kAwaitTuple));
        if (!read) co_return false;
        const auto failed = std::get<0>(*read);
        if (failed && failed != beast::http::error::need_buffer) co_return false;
        const std::string_view received(piece.data(), piece.size() - body.size);
        if (received.empty()) continue;
        const auto before = is_chunked ? fmt::format("{:x}\r\n", received.size()) : std::string();
        bool written = co_await writer_.write_all(before, received);
        if (written && is_chunked) written = co_await writer_.write_all("\r\n");
        if (!written) co_return false;
    }
    if (!is_chunked) co_return true;
    co_return co_await writer_.write_all("0\r\n\r\n");
}

asio::awaitable<void> Forwarder::pass_socket() {
    using namespace asio::experimental::awaitable_operators;
    const auto bytes = buffer_.cdata();
    const std::string_view early(static_cast<const char*>(bytes.data()), bytes.size());
    const bool written = co_await writer_.write_all(early);
    passes_socket_ = written && !stopped_;
    if (passes_socket_) {
        const auto pause_max = service_.config.write;
        co_await (pass_bytes(client_, *server_, pause_max) || pass_bytes(*server_, client_, pause_max));
    }
    passes_socket_ = false;
    server_.reset();
}

} // namespace scanloom::http
