#pragma once

#include "common/error/error.hpp"
#include "common/net/connect.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/verb.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::net {

/// Address and credentials for the server's HTTP port.
struct HttpPlace {
    Address server;
    TlsContext tls;     ///< null: without TLS
    std::string token;  ///< empty: none
    std::string advice; ///< for people: what to do if the server does not answer
};

inline constexpr unsigned kOk = 200; ///< HTTP status

struct HttpAnswer {
    unsigned status = 0;
    std::string etag;
    std::string body;
};

/// A connection to the server's HTTP port. It stays open between requests and is opened again if the server has closed
/// it.
/// Threads: one request at a time, on its executor.
class HttpConnection {
public:
    HttpConnection(boost::asio::any_io_executor executor, HttpPlace place);

    /// Sends a request and waits for the answer; connecting and the answer each have the timeout.
    /// Pre: the connection outlives the request.
    /// Errors: kUnreachable: the server does not answer; kTimeout.
    [[nodiscard]] boost::asio::awaitable<Result<HttpAnswer>> ask(boost::beast::http::verb method, std::string target,
                                                                 std::string if_none_match = {});
    [[nodiscard]] boost::asio::awaitable<Result<HttpAnswer>> get(std::string target) {
        return ask(boost::beast::http::verb::get, std::move(target));
    }

    void set_timeout(std::chrono::seconds timeout) noexcept { timeout_ = timeout; }
    /// Cancels the current request, if any.
    void close();

    [[nodiscard]] std::uint64_t bytes_in() const noexcept { return bytes_in_; }

private:
    using Request = boost::beast::http::request<boost::beast::http::empty_body>;
    using Parser = boost::beast::http::response_parser<boost::beast::http::string_body>;

    [[nodiscard]] boost::asio::awaitable<Result<>> connect();
    [[nodiscard]] boost::asio::awaitable<boost::system::error_code> exchange(const Request& request, Parser& parser);
    [[nodiscard]] Error unreachable(const std::string& why) const;

    boost::asio::any_io_executor executor_;
    HttpPlace place_;
    std::string authorization_;        // value of the header field; empty: none
    std::optional<LinkStream> stream_; // the current or last one
    boost::beast::flat_buffer buffer_;
    std::chrono::seconds timeout_{30};
    std::uint64_t bytes_in_ = 0;
    bool is_open_ = false;
};

/// Returns the value of an Authorization field; empty if there is no token.
[[nodiscard]] std::string authorization_of(const std::string& token);

} // namespace scanloom::net
