#pragma once

#include "server/ingest/robot_link.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstddef>
#include <cstdint>

namespace scanloom::ingest {

struct IngestConfig {
    LinkConfig link;
    std::size_t links_max = 10'000; ///< open at the same time; more are refused with an Error
};

/// Listens for robots and serves each on a link of its own.
/// Thread  the io_context's; start() and stop() from any.
class IngestServer {
public:
    /// Throws boost::system::system_error when the endpoint cannot be listened on.
    IngestServer(boost::asio::io_context& io, const boost::asio::ip::tcp::endpoint& endpoint, LinkServices services,
                 const IngestConfig& config);

    /// The port listened on, also when 0 was asked for.
    [[nodiscard]] std::uint16_t port() const { return port_; }

    void start();

    /// Accepts no more. Links end when their sessions close.
    void stop();

private:
    boost::asio::awaitable<void> accept();

    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    LinkServices services_;
    IngestConfig config_;
    std::size_t open_ = 0; // links, also those being turned away; on the acceptor's strand
};

} // namespace scanloom::ingest
