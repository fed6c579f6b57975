#include "robot_client/sources/ld06_device.hpp"

#include "common/error/error.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace scanloom::robot {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr unsigned kBaud = 230'400;

Result<> set_line(asio::serial_port& port) {
    using Port = asio::serial_port;
    error_code failed;
    const auto set = [&](auto option) {
        if (!failed) (void)port.set_option(option, failed);
    };
    set(Port::baud_rate(kBaud));
    set(Port::character_size(8));
    set(Port::parity(Port::parity::none));
    set(Port::stop_bits(Port::stop_bits::one));
    set(Port::flow_control(Port::flow_control::none));
    if (!failed) return {};
    return Error{Errc::kUnreachable,
                 fmt::format("cannot be set to {} baud ({}); is it a serial device?", kBaud, failed.message())};
}

asio::awaitable<Result<Ld06Link>> open(SerialDevice device, std::chrono::milliseconds) {
    asio::serial_port port(co_await asio::this_coro::executor);
    error_code failed;
    (void)port.open(device.path, failed);
    if (failed) {
        co_return Error{
            Errc::kUnreachable,
            fmt::format(
                "cannot be opened ({}); check its cable, its name and your permission to read it (group dialout)",
                failed.message())};
    }
    if (auto set = set_line(port); !set) co_return set.error();
    co_return Ld06Link(std::move(port));
}

asio::awaitable<error_code> connect(tcp::socket& socket, const net::Address& peer) {
    tcp::resolver resolver(co_await asio::this_coro::executor);
    auto [unknown, addresses] = co_await resolver.async_resolve(peer.host, peer.port, kAwaitTuple);
    if (unknown) co_return unknown;
    co_return std::get<0>(co_await asio::async_connect(socket, addresses, kAwaitTuple));
}

asio::awaitable<Result<Ld06Link>> open(net::Address peer, std::chrono::milliseconds timeout) {
    const auto executor = co_await asio::this_coro::executor;
    tcp::socket socket(executor);
    const auto failed = co_await net::within(timeout, connect(socket, peer));
    if (failed && !*failed) co_return Ld06Link(std::move(socket));
    const std::string why = failed ? failed->message() : fmt::format("no answer for {:g} s", seconds(timeout));
    co_return Error{Errc::kUnreachable,
                    fmt::format("cannot be reached ({}); check the address and that ser2net runs there", why)};
}

} // namespace

std::string name_of(const Ld06Endpoint& endpoint) {
    if (const auto* device = std::get_if<SerialDevice>(&endpoint)) return device->path;
    return "tcp://" + std::get<net::Address>(endpoint).text();
}

asio::awaitable<Result<Ld06Link>> open_link(Ld06Endpoint endpoint, std::chrono::milliseconds timeout) {
    auto link = co_await std::visit([&](auto& there) { return open(there, timeout); }, endpoint);
    if (!link) co_return prefixed(name_of(endpoint) + ": ", link.error());
    co_return link;
}

asio::awaitable<Result<std::size_t>> read_some(Ld06Link& link, std::span<std::uint8_t> bytes,
                                               std::chrono::milliseconds timeout) {
    const auto buffer = asio::buffer(bytes.data(), bytes.size());
    const auto read = co_await net::within(
        timeout, std::visit([&](auto& line) { return line.async_read_some(buffer, kAwaitTuple); }, link));
    if (!read) {
        co_return Error{Errc::kTimeout,
                        fmt::format("no byte for {:g} s; check that the sensor has power and turns", seconds(timeout))};
    }
    const auto [failed, count] = *read;
    if (!failed) co_return count;
    // a terminal without its other end reports an I/O error
    const bool hung_up = failed == asio::error::eof || failed == error_code(EIO, boost::system::system_category());
    co_return Error{Errc::kUnreachable,
                    hung_up ? "disconnected; check the cable" : fmt::format("cannot be read ({})", failed.message())};
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kReadBytes = 4096;
constexpr std::chrono::milliseconds kFirstWait{100};
constexpr std::chrono::milliseconds kLongestWait{2'000};

class Reading {
public:
    Reading(const Ld06DeviceOptions& options, Ld06Listener& listener) : options_(options), listener_(listener) {}

    asio::awaitable<Error> run();

private:
    [[nodiscard]] asio::awaitable<Error> read_once();
    [[nodiscard]] bool give_up(const Error& error);
    void take(std::span<const std::uint8_t> bytes);
    [[nodiscard]] asio::awaitable<bool> is_cancelled() const;
    [[nodiscard]] Error named(const Error& error) const { return prefixed(name_of(options_.endpoint) + ": ", error); }

    const Ld06DeviceOptions& options_;
    Ld06Listener& listener_;
    bool was_open_ = false;
    std::optional<Clock::time_point> gone_since_;
    std::chrono::milliseconds wait_ = kFirstWait;
    Clock::time_point packet_at_{};
    bool foreign_reported_ = false; ///< bytes that are not packets were reported
};

asio::awaitable<Error> Reading::run() {
    co_await asio::this_coro::throw_if_cancelled(false);
    for (;;) {
        const Error error = co_await read_once();
        if (co_await is_cancelled()) co_return Error{Errc::kShuttingDown, "reading the sensor was stopped"};
        if (give_up(error)) {
            const bool was_tried = options_.reopen_for.count() > 0 && was_open_;
            const auto tried = was_tried ? fmt::format(" (retried for {:g} s)", seconds(options_.reopen_for)) : "";
            co_return Error{error.code, error.message + tried};
        }
        asio::steady_timer timer(co_await asio::this_coro::executor, wait_);
        co_await timer.async_wait(kAwaitTuple);
        wait_ = std::min(2 * wait_, kLongestWait);
    }
}

/// Opens the device and reads it until that fails.
asio::awaitable<Error> Reading::read_once() {
    auto link = co_await open_link(options_.endpoint, options_.silent_max);
    if (!link) co_return link.error();
    was_open_ = true;
    packet_at_ = Clock::now();
    foreign_reported_ = false;
    listener_.on_open();
    std::array<std::uint8_t, kReadBytes> buffer;
    for (;;) {
        const auto count = co_await read_some(*link, buffer, options_.silent_max);
        if (!count) co_return named(count.error());
        take(std::span<const std::uint8_t>(buffer).first(*count));
    }
}

bool Reading::give_up(const Error& error) {
    if (!was_open_) return true;
    if (!gone_since_) {
        gone_since_ = Clock::now();
        if (options_.reopen_for.count() > 0) {
            options_.note(further(error.message, fmt::format("retrying for {:g} s", seconds(options_.reopen_for))));
        }
    }
    return Clock::now() - *gone_since_ >= options_.reopen_for;
}

void Reading::take(std::span<const std::uint8_t> bytes) {
    const auto now = Clock::now();
    if (listener_.on_bytes(bytes)) {
        if (gone_since_) options_.note(name_of(options_.endpoint) + ": packets are received again");
        gone_since_.reset();
        wait_ = kFirstWait;
        packet_at_ = now;
        foreign_reported_ = false;
    } else if (!foreign_reported_ && now - packet_at_ >= options_.silent_max) {
        foreign_reported_ = true;
        options_.note(fmt::format("{}: bytes without any packet of an LD06 for {:g} s; is it another device, or a line "
                                  "speed other than 230400 baud?",
                                  name_of(options_.endpoint), seconds(options_.silent_max)));
    }
}

asio::awaitable<bool> Reading::is_cancelled() const {
    co_return (co_await asio::this_coro::cancellation_state).cancelled() != asio::cancellation_type::none;
}

} // namespace

asio::awaitable<Error> read_ld06_device(Ld06DeviceOptions options, Ld06Listener& listener) {
    co_return co_await Reading(options, listener).run();
}

} // namespace scanloom::robot
