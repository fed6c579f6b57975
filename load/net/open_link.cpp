#include "load/net/open_link.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/error.hpp>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {} // namespace

net::LinkStream link_to(const HttpPlace& place, const asio::any_io_executor& executor) {
    asio::ip::tcp::socket socket(executor);
    if (!place.tls) return net::LinkStream(std::move(socket));
    return {std::move(socket), *place.tls};
}

asio::awaitable<boost::system::error_code> open_link(net::LinkStream& stream, const HttpPlace& place) {
    asio::ip::tcp::resolver resolver(stream.get_executor());
    const auto [unresolved, addresses] =
        co_await resolver.async_resolve(place.server.host, place.server.port, kAwaitTuple);
    if (unresolved) co_return unresolved;
    const auto [refused, endpoint] = co_await asio::async_connect(stream.socket(), addresses, kAwaitTuple);
    if (refused) co_return refused;
    boost::system::error_code ignored; // without it, small requests only wait longer
    stream.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    if (!place.tls) co_return refused;
    stream.expect_host(place.server.host);
    const auto [failed] = co_await stream.async_handshake(net::LinkStream::Role::kClient, kAwaitTuple);
    co_return failed;
}

std::string trouble_with(const net::LinkStream& stream, const boost::system::error_code& failed) {
    const bool is_of_tls = failed.category() == asio::error::get_ssl_category();
    return is_of_tls ? net::handshake_text(failed, stream.verify_result()) : failed.message();
}

} // namespace scanloom::load
