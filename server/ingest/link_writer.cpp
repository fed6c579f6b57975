#include "server/ingest/link_writer.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/write.hpp>

#include <utility>

namespace scanloom::ingest {
namespace asio = boost::asio;

LinkWriter::LinkWriter(net::LinkStream& stream, Outbox& outbox, std::function<void(std::uint64_t)> told)
    : stream_(stream), outbox_(outbox), told_(std::move(told)),
      emptied_(stream.get_executor(), std::chrono::steady_clock::time_point::max()) {}

void LinkWriter::start(std::shared_ptr<void> owner) {
    if (std::exchange(writing_, true)) return;
    asio::co_spawn(stream_.get_executor(), write(std::move(owner)), asio::detached);
}

asio::awaitable<void> LinkWriter::write([[maybe_unused]] std::shared_ptr<void> owner) {
    while (const auto piece = outbox_.next()) {
        if (piece->durable_seq) told_(*piece->durable_seq);
        const auto [error, written] = co_await asio::async_write(stream_, asio::buffer(piece->bytes), kAwaitTuple);
        if (error) break;
    }
    writing_ = false;
    emptied_.cancel();
}

asio::awaitable<void> LinkWriter::emptied() {
    if (writing_) co_await emptied_.async_wait(kAwaitTuple);
}

} // namespace scanloom::ingest
