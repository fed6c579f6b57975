#include "common/net/web_socket.hpp"

#include "common/net/await_tuple.hpp"

namespace scanloom::net {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;

asio::awaitable<error_code> accept(WebSocket& socket, const beast::http::request<beast::http::string_body>& upgrade) {
    const auto [failed] = co_await socket.async_accept(upgrade, kAwaitTuple);
    co_return failed;
}

asio::awaitable<error_code> shake_hands(WebSocket& socket, beast::websocket::response_type& answer,
                                        const std::string& host, const std::string& target) {
    const auto [failed] = co_await socket.async_handshake(answer, host, target, kAwaitTuple);
    co_return failed;
}

asio::awaitable<error_code> read(WebSocket& socket, beast::flat_buffer& message) {
    const auto [failed, size] = co_await socket.async_read(message, kAwaitTuple);
    co_return failed;
}

asio::awaitable<error_code> write(WebSocket& socket, std::span<const asio::const_buffer> parts) {
    const auto [failed, size] = co_await socket.async_write(parts, kAwaitTuple);
    co_return failed;
}

asio::awaitable<error_code> close(WebSocket& socket, const beast::websocket::close_reason& reason) {
    const auto [failed] = co_await socket.async_close(reason, kAwaitTuple);
    co_return failed;
}

} // namespace scanloom::net
