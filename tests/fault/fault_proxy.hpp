#pragma once

#include "tests/fault/link_harm.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <functional>
#include <thread>

namespace scanloom::fault {

/// The faults of one connection.
struct LinkFate {
    SpoiledStream there; ///< from the connecting side
    SpoiledStream back;
};

/// A proxy that spoils connections: forwards connections from its port to another port of this machine, each with its
/// own faults. Runs on its own thread.
class FaultProxy {
public:
    /// @param fate_of  called on the proxy's thread with the number of each connection: 0 for the first, then 1, and so
    ///     on
    FaultProxy(std::uint16_t to, std::function<LinkFate(std::uint64_t connection)> fate_of);
    ~FaultProxy();

    [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

private:
    boost::asio::awaitable<void> accept();
    boost::asio::awaitable<void> serve(boost::asio::ip::tcp::socket near, LinkFate fate);

    boost::asio::io_context io_{1};
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::ip::tcp::endpoint to_;
    std::function<LinkFate(std::uint64_t)> fate_of_;
    std::thread thread_;
};

} // namespace scanloom::fault
