#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::fault {

/// The behaviour of a hostile or broken client.
struct Behaviour {
    std::uint16_t port = 0;             ///< of this machine
    std::string opening;                ///< sent first
    std::string then{};                 ///< sent repeatedly after that; empty: nothing
    std::chrono::milliseconds pause{0}; ///< before each repetition
    bool reads = true;                  ///< false: received bytes are left unread
    std::chrono::seconds deadline{0};   ///< by which the server must close the connection; 0: none
};

/// Connections that keep a server busy while this object exists. A closed connection is opened again.
/// Thread  its own.
class Crowd {
public:
    explicit Crowd(const std::vector<Behaviour>& members);
    ~Crowd();
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    /// Waits until the number of connections made, including reconnections, is at least the number of members.
    void wait_until_connected() const;

    /// Returns how many connections of all members the server closed.
    [[nodiscard]] std::uint64_t disconnected() const;

    /// Waits until the server has closed a connection of every member whose deadline is at most `deadline`, for at most
    /// twice that time since construction, as the machine may be busy. @return the number of members whose connection
    /// was not closed
    [[nodiscard]] std::size_t wait_until_disconnected(std::chrono::seconds deadline) const;

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] boost::asio::awaitable<void> run_member(std::size_t member);
    [[nodiscard]] static boost::asio::awaitable<void> send(boost::asio::ip::tcp::socket& socket,
                                                           const Behaviour& behaviour);

    boost::asio::io_context io_{1};
    std::atomic<std::uint64_t> made_ = 0;
    const std::vector<Behaviour> members_;
    const Clock::time_point begun_ = Clock::now();
    mutable std::mutex mutex_; // guards the members below
    mutable std::condition_variable left_;
    std::vector<std::uint64_t> times_disconnected_; // by member
    std::thread thread_;
};

} // namespace scanloom::fault
