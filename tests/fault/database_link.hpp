#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <thread>

namespace scanloom::fault {

/// The network between a server and a database: forwards connections from one socket in the file system to another,
/// and can lose what passes in one direction without either side noticing. Runs on its own thread.
class DatabaseLink {
public:
    enum class Direction { kToDatabase, kFromDatabase };

    /// @param near  path of the socket to create
    /// @param far  path of the database's socket, which need not exist yet
    DatabaseLink(const std::filesystem::path& near, const std::filesystem::path& far);
    ~DatabaseLink();
    DatabaseLink(const DatabaseLink&) = delete;
    DatabaseLink& operator=(const DatabaseLink&) = delete;

    /// From now on, all bytes in this direction are lost, also the end of a connection. New connections are accepted.
    void cut(Direction direction);

    /// Closes all connections. New ones are forwarded.
    void restore();

private:
    using Socket = boost::asio::local::stream_protocol::socket;
    struct Pair;

    boost::asio::awaitable<void> accept();
    boost::asio::awaitable<void> connect(std::shared_ptr<Pair> pair);
    boost::asio::awaitable<void> forward(std::shared_ptr<Pair> pair, Direction direction);
    void close(const std::shared_ptr<Pair>& pair);
    void on_thread(const std::function<void()>& work);

    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    boost::asio::local::stream_protocol::acceptor acceptor_;
    boost::asio::local::stream_protocol::endpoint far_;
    std::array<bool, 2> is_cut_{};          // by direction
    std::set<std::shared_ptr<Pair>> pairs_; // open connections
    std::thread thread_;
};

} // namespace scanloom::fault
