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

constexpr std::chrono::milliseconds kComesAgainAfter{20};
constexpr int kReceiveBytes = 4096; // so that the receive buffer of a client that does not read is soon full

/// Reads until the server closes the connection.
asio::awaitable<void> listen(tcp::socket& socket, bool reads) {
    if (!reads) co_await socket.async_wait(tcp::socket::wait_error, kAwaitTuple);
    std::array<char, 4096> heard{};
    for (;;) {
        const auto [failed, bytes] = co_await socket.async_read_some(asio::buffer(heard), kAwaitTuple);
        if (failed) co_return;
    }
}

} // namespace

Crowd::Crowd(const std::vector<Manner>& members) : members_(members), times_hung_up_on_(members.size()) {
    for (std::size_t member = 0; member < members_.size(); ++member) {
        asio::co_spawn(io_, belong(member), asio::detached);
    }
    thread_ = std::thread([this] { io_.run(); });
}

Crowd::~Crowd() {
    io_.stop();
    thread_.join();
}

void Crowd::wait_until_there() const {
    for (auto made = made_.load(); made < members_.size(); made = made_.load()) made_.wait(made);
}

std::uint64_t Crowd::hung_up_on() const {
    const std::lock_guard lock(mutex_);
    return std::accumulate(times_hung_up_on_.begin(), times_hung_up_on_.end(), std::uint64_t{0});
}

std::size_t Crowd::wait_until_hung_up_on(std::chrono::seconds deadline) const {
    const auto is_there_still = [&](std::size_t member) {
        const auto& own = members_[member].deadline;
        return own > std::chrono::seconds(0) && own <= deadline && times_hung_up_on_[member] == 0;
    };
    std::unique_lock lock(mutex_);
    std::size_t there = 0;
    left_.wait_until(lock, begun_ + 2 * deadline, [&] {
        there = 0;
        for (std::size_t member = 0; member < members_.size(); ++member) there += is_there_still(member) ? 1 : 0;
        return there == 0;
    });
    return there;
}

asio::awaitable<void> Crowd::belong(std::size_t member) {
    const Manner& manner = members_[member];
    asio::steady_timer pause(io_);
    for (;;) {
        tcp::socket socket(io_);
        socket.open(tcp::v4());
        socket.set_option(tcp::socket::receive_buffer_size(kReceiveBytes));
        const auto [failed] =
            co_await socket.async_connect({asio::ip::address_v4::loopback(), manner.port}, kAwaitTuple);
        if (!failed) {
            ++made_;
            made_.notify_all();
            co_await (listen(socket, manner.reads) && speak(socket, manner));
            const std::lock_guard lock(mutex_);
            ++times_hung_up_on_[member];
            left_.notify_all();
        }
        pause.expires_after(kComesAgainAfter);
        co_await pause.async_wait(kAwaitTuple);
    }
}

/// Sends until the server no longer accepts data.
asio::awaitable<void> Crowd::speak(tcp::socket& socket, const Manner& manner) {
    asio::steady_timer pause(socket.get_executor());
    const auto [unsaid, bytes] = co_await asio::async_write(socket, asio::buffer(manner.opening), kAwaitTuple);
    if (unsaid || manner.then.empty()) co_return;
    for (;;) {
        pause.expires_after(manner.pause);
        co_await pause.async_wait(kAwaitTuple);
        const auto [failed, count] = co_await asio::async_write(socket, asio::buffer(manner.then), kAwaitTuple);
        if (failed) co_return;
    }
}

} // namespace scanloom::fault
