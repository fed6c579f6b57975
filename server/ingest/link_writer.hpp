#pragma once

#include "common/net/link_stream.hpp"
#include "server/ingest/outbox.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstdint>
#include <functional>
#include <memory>

namespace scanloom::ingest {

/// Writes what is in a link's outbox to its stream.
/// Thread  the stream's executor, a strand.
class LinkWriter {
public:
    /// Both must outlive this. `told` is called with the durable_seq of each ack that is handed to the socket.
    LinkWriter(net::LinkStream& stream, Outbox& outbox, std::function<void(std::uint64_t)> told);

    /// Writes until nothing is left, unless it does so already. `owner` keeps all alive meanwhile.
    void start(std::shared_ptr<void> owner);

    /// Returns when all is written, or the connection has failed.
    [[nodiscard]] boost::asio::awaitable<void> emptied();

private:
    [[nodiscard]] boost::asio::awaitable<void> write(std::shared_ptr<void> owner);

    net::LinkStream& stream_;
    Outbox& outbox_;
    std::function<void(std::uint64_t)> told_;
    bool writing_ = false;
    boost::asio::steady_timer emptied_; // never runs out; cancelled when there is nothing left
};

} // namespace scanloom::ingest
