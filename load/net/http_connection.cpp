#include "load/net/http_connection.hpp"

#include "load/core/words.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

namespace {

constexpr auto kUse = asio::as_tuple(asio::use_awaitable);
constexpr std::uint64_t kBodyMax = std::uint64_t{64} << 20;

} // namespace

std::string authorization_of(const std::string& token) { return token.empty() ? token : "Bearer " + token; }

HttpConnection::HttpConnection(asio::any_io_executor executor, robot::ServerAddress server, const std::string& token)
    : server_(std::move(server)), authorization_(authorization_of(token)), stream_(std::move(executor)) {}

asio::awaitable<boost::system::error_code> HttpConnection::connect() {
    asio::ip::tcp::resolver resolver(stream_.get_executor());
    const auto [unresolved, addresses] = co_await resolver.async_resolve(server_.host, server_.port, kUse);
    if (unresolved) co_return unresolved;
    const auto [refused, endpoint] = co_await stream_.async_connect(addresses, kUse);
    if (refused) co_return refused;
    is_open_ = true;
    buffer_.clear();
    boost::system::error_code ignored; // without it small requests only wait longer
    stream_.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    co_return refused;
}

asio::awaitable<Result<HttpAnswer>> HttpConnection::ask(http::verb method, std::string target,
                                                        std::string if_none_match) {
    http::request<http::empty_body> request(method, target, 11);
    request.set(http::field::host, fmt::format("{}:{}", server_.host, server_.port));
    if (!authorization_.empty()) request.set(http::field::authorization, authorization_);
    if (!if_none_match.empty()) request.set(http::field::if_none_match, if_none_match);
    boost::system::error_code failed;
    for (;;) {
        const bool was_open = is_open_;
        stream_.expires_after(patience_);
        failed = {};
        if (!was_open) failed = co_await connect();
        http::response_parser<http::string_body> parser;
        parser.body_limit(kBodyMax);
        if (!failed) std::tie(failed, std::ignore) = co_await http::async_write(stream_, request, kUse);
        if (!failed) {
            const auto [unread, count] = co_await http::async_read(stream_, buffer_, parser, kUse);
            failed = unread;
            bytes_in_ += count;
        }
        if (!failed) {
            if (!parser.get().keep_alive()) close();
            stream_.expires_never();
            co_return HttpAnswer{parser.get().result_int(), std::string(parser.get()[http::field::etag]),
                                 std::move(parser.get().body())};
        }
        close();
        if (!was_open || failed == beast::error::timeout) break; // or the server has closed it while it was idle
    }
    if (failed == beast::error::timeout) {
        co_return Error{Errc::kTimeout, fmt::format("{}:{} did not answer {} within {} s", server_.host, server_.port,
                                                    target, patience_.count())};
    }
    co_return Error{Errc::kUnreachable, fmt::format("{}:{} does not answer HTTP: {}; give the server's HTTP port to "
                                                    "--http, or --verify none without viewers and tile readers",
                                                    server_.host, server_.port, failed.message())};
}

void HttpConnection::close() {
    is_open_ = false;
    boost::system::error_code ignored;
    stream_.socket().close(ignored);
}

Error refusal(const HttpAnswer& answer, const std::string& target) {
    return {Errc::kInternal,
            harmless(fmt::format("{} was answered {}: {}", target, answer.status, answer.body.substr(0, 300)))};
}

} // namespace scanloom::load
