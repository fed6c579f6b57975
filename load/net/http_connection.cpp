#include "load/net/http_connection.hpp"

#include "common/net/await_tuple.hpp"
#include "load/core/words.hpp"
#include "load/net/open_link.hpp"

#include <boost/asio/error.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;
namespace http = boost::beast::http;

namespace {

constexpr std::uint64_t kBodyMax = std::uint64_t{64} << 20;

} // namespace

std::string authorization_of(const std::string& token) { return token.empty() ? token : "Bearer " + token; }

HttpConnection::HttpConnection(asio::any_io_executor executor, HttpPlace place)
    : executor_(std::move(executor)), place_(std::move(place)), authorization_(authorization_of(place_.token)) {}

asio::awaitable<boost::system::error_code> HttpConnection::connect() {
    stream_.emplace(link_to(place_, executor_));
    buffer_.clear();
    const auto failed = co_await open_link(*stream_, place_);
    is_open_ = !failed;
    co_return failed;
}

asio::awaitable<boost::system::error_code> HttpConnection::exchange(const Request& request, Parser& parser) {
    if (!is_open_) {
        const auto failed = co_await connect();
        if (failed) co_return failed;
    }
    const auto [unsent, sent] = co_await http::async_write(*stream_, request, kAwaitTuple);
    if (unsent) co_return unsent;
    const auto [unread, count] = co_await http::async_read(*stream_, buffer_, parser, kAwaitTuple);
    bytes_in_ += count;
    co_return unread;
}

asio::awaitable<boost::system::error_code> HttpConnection::within_timeout(const Request& request, Parser& parser) {
    using namespace asio::experimental::awaitable_operators;
    asio::steady_timer timer(executor_);
    timer.expires_after(timeout_);
    const auto first = co_await (exchange(request, parser) || timer.async_wait(kAwaitTuple));
    if (first.index() != 0) co_return boost::system::error_code(asio::error::timed_out);
    co_return std::get<0>(first);
}

asio::awaitable<Result<HttpAnswer>> HttpConnection::ask(http::verb method, std::string target,
                                                        std::string if_none_match) {
    Request request(method, target, 11);
    request.set(http::field::host, fmt::format("{}:{}", place_.server.host, place_.server.port));
    if (!authorization_.empty()) request.set(http::field::authorization, authorization_);
    if (!if_none_match.empty()) request.set(http::field::if_none_match, if_none_match);
    for (;;) {
        const bool was_open = is_open_;
        Parser parser;
        parser.body_limit(kBodyMax);
        const auto failed = co_await within_timeout(request, parser);
        if (!failed) {
            if (!parser.get().keep_alive()) close();
            co_return HttpAnswer{parser.get().result_int(), std::string(parser.get()[http::field::etag]),
                                 std::move(parser.get().body())};
        }
        close();
        if (was_open && failed != asio::error::timed_out) continue; // the server has closed the idle connection
        if (failed != asio::error::timed_out) co_return unreachable(failed);
        co_return Error{Errc::kTimeout, fmt::format("{}:{} did not answer {} within {} s", place_.server.host,
                                                    place_.server.port, target, timeout_.count())};
    }
}

Error HttpConnection::unreachable(const boost::system::error_code& failed) const {
    return {Errc::kUnreachable,
            fmt::format("{}:{} does not answer {}: {}; give the server's HTTP port to --http, or --verify none "
                        "without viewers and tile readers",
                        place_.server.host, place_.server.port, place_.tls ? "HTTPS" : "HTTP",
                        trouble_with(*stream_, failed))};
}

void HttpConnection::close() {
    is_open_ = false;
    if (stream_) stream_->close();
}

Error refusal(const HttpAnswer& answer, const std::string& target) {
    return {Errc::kInternal,
            harmless(fmt::format("{} was answered with {}: {}", target, answer.status, answer.body.substr(0, 300)))};
}

} // namespace scanloom::load
