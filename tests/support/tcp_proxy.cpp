#include "tests/support/tcp_proxy.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>

#include <array>

namespace scanloom::test {

namespace asio = boost::asio;
using asio::ip::tcp;

struct TcpProxy::Pair {
    explicit Pair(tcp::socket accepted) : near(std::move(accepted)), far(near.get_executor()) {}

    void close() {
        boost::system::error_code ignored;
        near.close(ignored);
        far.close(ignored);
    }

    tcp::socket near;
    tcp::socket far;
    std::array<std::array<char, 4096>, 2> bytes;
};

TcpProxy::TcpProxy(std::uint16_t to)
    : acceptor_(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)), endpoint_(acceptor_.local_endpoint()),
      to_(asio::ip::address_v4::loopback(), to), thread_([this] { io_.run(); }) {
    asio::post(io_, [this] { accept(); });
}

TcpProxy::~TcpProxy() {
    io_.stop();
    thread_.join();
}

void TcpProxy::on_thread(const std::function<void()>& work) { asio::post(io_, asio::use_future(work)).get(); }

void TcpProxy::cut() {
    on_thread([this] {
        acceptor_.close();
        for (const auto& weak : pairs_) {
            if (const auto pair = weak.lock()) pair->close();
        }
        pairs_.clear();
    });
}

void TcpProxy::restore() {
    on_thread([this] {
        acceptor_.open(endpoint_.protocol());
        acceptor_.set_option(tcp::acceptor::reuse_address(true));
        acceptor_.bind(endpoint_);
        acceptor_.listen();
        accept();
    });
}

void TcpProxy::accept() {
    acceptor_.async_accept([this](const boost::system::error_code& failed, tcp::socket socket) {
        if (failed) return;
        const auto pair = std::make_shared<Pair>(std::move(socket));
        pairs_.push_back(pair);
        pair->far.async_connect(to_, [this, pair](const boost::system::error_code& refused) {
            if (refused) return pair->close();
            forward(pair, false);
            forward(pair, true);
        });
        accept();
    });
}

void TcpProxy::forward(const std::shared_ptr<Pair>& pair, bool back) {
    auto& from = back ? pair->far : pair->near;
    auto& to = back ? pair->near : pair->far;
    auto& bytes = pair->bytes[back ? 1 : 0];
    from.async_read_some(asio::buffer(bytes), [this, pair, back, &to, &bytes](const auto& failed, std::size_t count) {
        if (failed) return pair->close();
        asio::async_write(to, asio::buffer(bytes, count), [this, pair, back](const auto& broken, std::size_t) {
            if (broken) return pair->close();
            forward(pair, back);
        });
    });
}

} // namespace scanloom::test
