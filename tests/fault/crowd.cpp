#include "tests/fault/crowd.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include <array>
#include <numeric>

namespace scanloom::fault {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace asio::experimental::awaitable_operators;

namespace {

constexpr std::chrono::milliseconds kReconnectDelay{20};
constexpr int kReceiveBytes = 4096; // so that the receive buffer of a client that does not read is soon full

/// Reads until the server closes the connection.
asio::awaitable<void> listen(tcp::socket& socket, bool reads) {
    if (!reads) co_await socket.async_wait(tcp::socket::wait_error, kAwaitTuple);
    std::array<char, 4096> received{};
    for (;;) {
        const auto [failed, bytes] = co_await socket.async_read_some(asio::buffer(received), kAwaitTuple);
        if (failed) co_return;
    }
}

} // namespace

Crowd::Crowd(const std::vector<Behaviour>& members) : members_(members), times_disconnected_(members.size()) {
    for (std::size_t member = 0; member < members_.size(); ++member) {
        asio::co_spawn(io_, run_member(member), asio::detached);
    }
    thread_ = std::thread([this] { io_.run(); });
}

Crowd::~Crowd() {
    io_.stop();
    thread_.join();
}

void Crowd::wait_until_connected() const {
    for (auto made = made_.load(); made < members_.size(); made = made_.load()) made_.wait(made);
}

std::uint64_t Crowd::disconnected() const {
    const std::lock_guard lock(mutex_);
    return std::accumulate(times_disconnected_.begin(), times_disconnected_.end(), std::uint64_t{0});
}

std::size_t Crowd::wait_until_disconnected(std::chrono::seconds deadline) const {
    const auto is_connected = [&](std::size_t member) {
        const auto& own = members_[member].deadline;
        return own > std::chrono::seconds(0) && own <= deadline && times_disconnected_[member] == 0;
    };
    std::unique_lock lock(mutex_);
    std::size_t connected = 0;
    left_.wait_until(lock, begun_ + 2 * deadline, [&] {
        connected = 0;
        for (std::size_t member = 0; member < members_.size(); ++member) connected += is_connected(member) ? 1 : 0;
        return connected == 0;
    });
    return connected;
}

asio::awaitable<void> Crowd::run_member(std::size_t member) {
    const Behaviour& behaviour = members_[member];
    asio::steady_timer pause(io_);
    for (;;) {
        tcp::socket socket(io_);
        socket.open(tcp::v4());
        socket.set_option(tcp::socket::receive_buffer_size(kReceiveBytes));
        const auto [failed] =
            co_await socket.async_connect({asio::ip::address_v4::loopback(), behaviour.port}, kAwaitTuple);
        if (!failed) {
            ++made_;
            made_.notify_all();
            co_await (listen(socket, behaviour.reads) && send(socket, behaviour));
            const std::lock_guard lock(mutex_);
            ++times_disconnected_[member];
            left_.notify_all();
        }
        pause.expires_after(kReconnectDelay);
        co_await pause.async_wait(kAwaitTuple);
    }
}

/// Sends until the server no longer accepts data.
asio::awaitable<void> Crowd::send(tcp::socket& socket, const Behaviour& behaviour) {
    asio::steady_timer pause(socket.get_executor());
    const auto [unsent, bytes] = co_await asio::async_write(socket, asio::buffer(behaviour.opening), kAwaitTuple);
    if (unsent || behaviour.then.empty()) co_return;
    for (;;) {
        pause.expires_after(behaviour.pause);
        co_await pause.async_wait(kAwaitTuple);
        const auto [failed, count] = co_await asio::async_write(socket, asio::buffer(behaviour.then), kAwaitTuple);
        if (failed) co_return;
    }
}

} // namespace scanloom::fault
