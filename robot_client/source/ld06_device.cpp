#include "robot_client/source/ld06_device.hpp"

#include "common/error/further.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/source/seconds.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace scanloom::robot {

namespace asio = boost::asio;

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
