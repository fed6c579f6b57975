#include "common/net/http_connection.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::net {

namespace asio = boost::asio;
namespace http = boost::beast::http;

namespace {

constexpr std::uint64_t kBodyMax = std::uint64_t{64} << 20;

} // namespace

std::string authorization_of(const std::string& token) { return token.empty() ? token : "Bearer " + token; }

HttpConnection::HttpConnection(asio::any_io_executor executor, HttpPlace place)
    : executor_(std::move(executor)), place_(std::move(place)), authorization_(authorization_of(place_.token)) {}

asio::awaitable<Result<>> HttpConnection::connect() {
    stream_.emplace(client_stream(executor_, place_.tls));
    buffer_.clear();
    const auto connected = co_await net::connect(*stream_, place_.server, timeout_, {"--http", "scanloom-server"});
    is_open_ = connected.has_value();
    co_return connected;
}

asio::awaitable<boost::system::error_code> HttpConnection::exchange(const Request& request, Parser& parser) {
    const auto [unsent, sent] = co_await http::async_write(*stream_, request, kAwaitTuple);
    if (unsent) co_return unsent;
    const auto [unread, count] = co_await http::async_read(*stream_, buffer_, parser, kAwaitTuple);
    bytes_in_ += count;
    co_return unread;
}

asio::awaitable<Result<HttpAnswer>> HttpConnection::ask(http::verb method, std::string target,
                                                        std::string if_none_match) {
    Request request(method, target, 11);
    request.set(http::field::host, place_.server.text());
    if (!authorization_.empty()) request.set(http::field::authorization, authorization_);
    if (!if_none_match.empty()) request.set(http::field::if_none_match, if_none_match);
    for (;;) {
        const bool was_open = is_open_;
        if (!was_open) {
            const auto connected = co_await connect();
            if (!connected) co_return unreachable(connected.error().message);
        }
        Parser parser;
        parser.body_limit(kBodyMax);
        const auto failed = co_await within(timeout_, exchange(request, parser));
        if (failed && !*failed) {
            if (!parser.get().keep_alive()) close();
            co_return HttpAnswer{parser.get().result_int(), std::string(parser.get()[http::field::etag]),
                                 std::move(parser.get().body())};
        }
        close();
        if (!failed) {
            co_return Error{Errc::kTimeout, fmt::format("{} did not answer {} within {} s", place_.server.text(),
                                                        target, timeout_.count())};
        }
        if (!was_open) co_return unreachable(failure_text(*stream_, *failed));
        // Otherwise the server has closed the idle connection.
    }
}

Error HttpConnection::unreachable(const std::string& why) const {
    return {Errc::kUnreachable, fmt::format("{} does not answer {} ({}); {}", place_.server.text(),
                                            place_.tls ? "HTTPS" : "HTTP", why, place_.advice)};
}

void HttpConnection::close() {
    is_open_ = false;
    if (stream_) stream_->close();
}

} // namespace scanloom::net
