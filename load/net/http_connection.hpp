#pragma once

#include "common/error/error.hpp"
#include "robot_client/uplink/server_address.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/verb.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::load {

struct HttpAnswer {
    unsigned status = 0;
    std::string etag;
    std::string body;
};

/// A connection to the server's HTTP port that is kept open between requests, and made anew when the server has closed
/// it meanwhile.
/// Thread  one request at a time, on its executor.
class HttpConnection {
public:
    /// `token` is shown with every request; empty: none.
    HttpConnection(boost::asio::any_io_executor executor, robot::ServerAddress server, const std::string& token);

    /// Pre     the connection stays until this is done.
    /// Errors  kUnreachable: nobody answers; kTimeout.
    [[nodiscard]] boost::asio::awaitable<Result<HttpAnswer>> ask(boost::beast::http::verb method, std::string target,
                                                                 std::string if_none_match = {});
    [[nodiscard]] boost::asio::awaitable<Result<HttpAnswer>> get(std::string target) {
        return ask(boost::beast::http::verb::get, std::move(target));
    }

    void set_patience(std::chrono::seconds patience) noexcept { patience_ = patience; }
    /// Ends the request that is under way, if there is one.
    void close();

    [[nodiscard]] std::uint64_t bytes_in() const noexcept { return bytes_in_; }
    [[nodiscard]] const robot::ServerAddress& server() const noexcept { return server_; }

private:
    [[nodiscard]] boost::asio::awaitable<boost::system::error_code> connect();

    robot::ServerAddress server_;
    std::string authorization_; // empty: none
    boost::beast::tcp_stream stream_;
    boost::beast::flat_buffer buffer_;
    std::chrono::seconds patience_{30};
    std::uint64_t bytes_in_ = 0;
    bool is_open_ = false;
};

/// What an Authorization field holds; empty where there is no token.
[[nodiscard]] std::string authorization_of(const std::string& token);

/// What the server says of an answer that is not the one asked for, as a failure.
[[nodiscard]] Error refusal(const HttpAnswer& answer, const std::string& target);

} // namespace scanloom::load
