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

/// What somebody does who means no good, or cannot help it.
struct Manner {
    std::uint16_t port = 0;             ///< of this machine
    std::string opening;                ///< said at once
    std::string then{};                 ///< said again and again after that; empty: nothing
    std::chrono::milliseconds pause{0}; ///< before each of it
    bool reads = true;                  ///< or leaves whatever comes where it is
    std::chrono::seconds deadline{0};   ///< within which the server is to hang up; 0: it need not
};

/// Connections that keep a server busy until this goes. Whoever is hung up on comes again.
/// Thread  one of its own.
class Crowd {
public:
    explicit Crowd(const std::vector<Manner>& members);
    ~Crowd();
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    /// Waits until as many connections as there are members have been made, those that were made again included.
    void wait_until_there() const;

    /// How often, all members together.
    [[nodiscard]] std::uint64_t hung_up_on() const;

    /// Waits until every member whose deadline is no later than this one was hung up on; but no longer than its
    /// deadline twice over, as the machine may be busy. @return how many were not
    [[nodiscard]] std::size_t wait_until_hung_up_on(std::chrono::seconds deadline) const;

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] boost::asio::awaitable<void> belong(std::size_t member);
    [[nodiscard]] static boost::asio::awaitable<void> speak(boost::asio::ip::tcp::socket& socket, const Manner& manner);

    boost::asio::io_context io_{1};
    std::atomic<std::uint64_t> made_ = 0;
    const std::vector<Manner> members_;
    const Clock::time_point begun_ = Clock::now();
    mutable std::mutex mutex_; // guards what follows
    mutable std::condition_variable left_;
    std::vector<std::uint64_t> times_hung_up_on_; // by member
    std::thread thread_;
};

} // namespace scanloom::fault
