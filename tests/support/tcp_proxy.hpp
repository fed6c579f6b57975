#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <thread>

namespace scanloom::test {

/// A connection that can be cut: forwards connections from its port to another port of this machine, on its own thread.
class TcpProxy {
public:
    explicit TcpProxy(std::uint16_t to);
    ~TcpProxy();

    [[nodiscard]] std::uint16_t port() const noexcept { return endpoint_.port(); }

    /// Resets every connection and refuses new ones until restore().
    void cut();
    void restore();

private:
    struct Pair;

    void accept();
    void forward(const std::shared_ptr<Pair>& pair, bool back);
    void on_thread(const std::function<void()>& work);

    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::ip::tcp::endpoint endpoint_;
    boost::asio::ip::tcp::endpoint to_;
    std::list<std::weak_ptr<Pair>> pairs_;
    std::thread thread_;
};

} // namespace scanloom::test
