#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
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

    [[nodiscard]] std::uint64_t hung_up_on() const noexcept { return hung_up_on_; }

private:
    [[nodiscard]] boost::asio::awaitable<void> belong(Manner manner);
    [[nodiscard]] static boost::asio::awaitable<void> speak(boost::asio::ip::tcp::socket& socket, const Manner& manner);

    boost::asio::io_context io_{1};
    const std::size_t size_;
    std::atomic<std::uint64_t> made_ = 0;
    std::atomic<std::uint64_t> hung_up_on_ = 0;
    std::thread thread_;
};

} // namespace scanloom::fault
