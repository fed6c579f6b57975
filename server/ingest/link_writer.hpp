#pragma once

#include "common/net/link_stream.hpp"
#include "server/ingest/outbox.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstdint>
#include <functional>
#include <memory>

namespace scanloom::ingest {

/// Writes the content of a link's outbox to its stream.
/// Threads: the stream's executor, a strand.
class LinkWriter {
public:
    /// @param stream  outlives this object
    /// @param outbox  outlives this object
    /// @param told    called with the durable_seq of each ack that is passed to the socket
    LinkWriter(net::LinkStream& stream, Outbox& outbox, std::function<void(std::uint64_t)> told);

    /// Starts writing until the outbox is empty, unless a write is already running.
    /// @param owner  keeps this object and its stream alive during the write
    void start(std::shared_ptr<void> owner);

    /// Returns when the outbox is written, or the connection has failed.
    [[nodiscard]] boost::asio::awaitable<void> emptied();

private:
    [[nodiscard]] boost::asio::awaitable<void> write(std::shared_ptr<void> owner);

    net::LinkStream& stream_;
    Outbox& outbox_;
    std::function<void(std::uint64_t)> told_;
    bool writing_ = false;
    boost::asio::steady_timer emptied_; // never expires; cancelled when the write ends
};

} // namespace scanloom::ingest
