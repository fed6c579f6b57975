#include "tests/fault/database_link.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>

#include <cstddef>
#include <utility>

namespace scanloom::fault {

namespace asio = boost::asio;
using asio::local::stream_protocol;

/// The two halves of a connection.
struct DatabaseLink::Pair {
    Socket near;
    Socket far;
};

DatabaseLink::DatabaseLink(const std::filesystem::path& near, const std::filesystem::path& far)
    : acceptor_(io_, stream_protocol::endpoint(near.native())), far_(far.native()) {
    asio::co_spawn(io_, accept(), asio::detached);
    thread_ = std::thread([this] { io_.run(); });
}

DatabaseLink::~DatabaseLink() {
    io_.stop();
    thread_.join();
}

void DatabaseLink::on_thread(const std::function<void()>& work) { asio::post(io_, asio::use_future(work)).get(); }

void DatabaseLink::cut(Direction direction) {
    on_thread([this, direction] { is_cut_[static_cast<std::size_t>(direction)] = true; });
}

void DatabaseLink::restore() {
    on_thread([this] {
        is_cut_ = {};
        while (!pairs_.empty()) close(*pairs_.begin());
    });
}

void DatabaseLink::close(const std::shared_ptr<Pair>& pair) {
    boost::system::error_code ignored;
    pair->near.close(ignored);
    pair->far.close(ignored);
    pairs_.erase(pair);
}

asio::awaitable<void> DatabaseLink::accept() {
    for (;;) {
        auto [failed, socket] = co_await acceptor_.async_accept(kAwaitTuple);
        if (failed) co_return;
        const auto pair = std::make_shared<Pair>(std::move(socket), Socket(io_));
        pairs_.insert(pair);
        asio::co_spawn(io_, connect(pair), asio::detached);
    }
}

asio::awaitable<void> DatabaseLink::connect(std::shared_ptr<Pair> pair) {
    const auto [refused] = co_await pair->far.async_connect(far_, kAwaitTuple);
    if (refused) co_return close(pair);
    asio::co_spawn(io_, forward(pair, Direction::kToDatabase), asio::detached);
    asio::co_spawn(io_, forward(pair, Direction::kFromDatabase), asio::detached);
}

/// Forwards one direction until the connection ends, or the direction is cut: then it stays open without a reader.
asio::awaitable<void> DatabaseLink::forward(std::shared_ptr<Pair> pair, Direction direction) {
    Socket& from = direction == Direction::kToDatabase ? pair->near : pair->far;
    Socket& to = direction == Direction::kToDatabase ? pair->far : pair->near;
    const bool& is_cut = is_cut_[static_cast<std::size_t>(direction)];
    std::array<char, 16'384> bytes{};
    for (;;) {
        const auto [failed, count] = co_await from.async_read_some(asio::buffer(bytes), kAwaitTuple);
        if (is_cut) co_return;
        if (failed) co_return close(pair);
        const auto [broken, written] = co_await asio::async_write(to, asio::buffer(bytes, count), kAwaitTuple);
        if (broken) co_return close(pair);
    }
}

} // namespace scanloom::fault
