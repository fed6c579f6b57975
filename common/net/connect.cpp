#include "common/net/connect.hpp"

#include "common/text/parse_number.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <fmt/format.h>

#include <netinet/tcp.h>

#include <cstdint>

namespace scanloom::net {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

Error unreachable(std::string message) { return {Errc::kUnreachable, std::move(message)}; }

Result<Endpoints> endpoints_of(const Address& address, const boost::system::error_code& failed,
                               const tcp::resolver::results_type& found, PeerName peer) {
    if (failed) {
        return unreachable(fmt::format("cannot find {}: {}; check {}", address.text(), failed.message(), peer.option));
    }
    Endpoints endpoints;
    for (const auto& entry : found) endpoints.push_back(entry.endpoint());
    return endpoints;
}

double in_seconds(std::chrono::milliseconds time) { return std::chrono::duration<double>(time).count(); }

} // namespace

std::string Address::text() const {
    return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port) : fmt::format("[{}]:{}", host, port);
}

Result<Address> parse_address(std::string_view text) {
    const Error other_form{Errc::kInvalidField, fmt::format("'{}' is not HOST:PORT", text)};
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) return other_form;
    std::string_view host = text.substr(0, colon);
    const std::string_view port = text.substr(colon + 1);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    } else if (host.find(':') != std::string_view::npos) {
        return other_form; // an IPv6 address without brackets is ambiguous
    }
    if (host.empty() || parse_number<std::uint16_t>(port).value_or(0) == 0) return other_form;
    return Address{std::string(host), std::string(port)};
}

Result<Endpoints> resolve(const Address& address) {
    asio::io_context io;
    boost::system::error_code failed;
    const auto found = tcp::resolver(io).resolve(address.host, address.port, failed);
    return endpoints_of(address, failed, found, {});
}

LinkStream client_stream(asio::any_io_executor executor, const TlsContext& tls) {
    LinkStream::Socket socket(std::move(executor));
    return tls ? LinkStream(std::move(socket), *tls) : LinkStream(std::move(socket));
}

asio::awaitable<Result<>> connect(LinkStream& stream, Address address, Endpoints endpoints,
                                  std::chrono::milliseconds timeout, PeerName peer) {
    const auto connected = co_await within(timeout, asio::async_connect(stream.socket(), endpoints, kAwaitTuple));
    const auto refused = connected ? std::get<0>(*connected) : asio::error::operation_aborted;
    if (refused == asio::error::operation_aborted) {
        co_return unreachable(fmt::format("no connection to {} within {:g} s; check {} and the network", address.text(),
                                          in_seconds(timeout), peer.option));
    }
    if (refused) {
        co_return unreachable(fmt::format("cannot connect to {}: {}; is {} running there?", address.text(),
                                          refused.message(), peer.program));
    }
    boost::system::error_code ignored; // without no_delay small messages only wait longer
    stream.socket().set_option(tcp::no_delay(true), ignored);
    if (!stream.is_encrypted()) co_return Result<>();
    stream.expect_host(address.host);
    const auto shaken = co_await within(timeout, stream.async_handshake(LinkStream::Role::kClient, kAwaitTuple));
    if (!shaken) {
        co_return unreachable(
            fmt::format("{} did not answer with TLS within {:g} s", address.text(), in_seconds(timeout)));
    }
    const auto [failed] = *shaken;
    if (!failed) co_return Result<>();
    co_return unreachable(
        fmt::format("no encrypted link to {}: {}", address.text(), handshake_text(failed, stream.verify_result())));
}

void set_unconfirmed_max([[maybe_unused]] LinkStream& stream, [[maybe_unused]] std::chrono::milliseconds time) {
#ifdef TCP_USER_TIMEOUT
    const auto milliseconds = static_cast<unsigned>(time.count());
    static_cast<void>(::setsockopt(stream.socket().native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &milliseconds,
                                   sizeof milliseconds)); // if it fails, a dead peer is noticed later
#endif
}

asio::awaitable<Result<>> connect(LinkStream& stream, Address address, std::chrono::milliseconds timeout,
                                  PeerName peer) {
    tcp::resolver resolver(stream.get_executor());
    const auto [failed, found] = co_await resolver.async_resolve(address.host, address.port, kAwaitTuple);
    auto endpoints = endpoints_of(address, failed, found, peer);
    if (!endpoints) co_return endpoints.error();
    co_return co_await connect(stream, std::move(address), std::move(*endpoints), timeout, peer);
}

std::string failure_text(const LinkStream& stream, const boost::system::error_code& failed) {
    const bool is_of_tls = failed.category() == asio::error::get_ssl_category();
    return is_of_tls ? handshake_text(failed, stream.verify_result()) : failed.message();
}

} // namespace scanloom::net
