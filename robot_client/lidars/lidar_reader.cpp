#include "robot_client/lidars/lidar_reader.hpp"

#include "common/net/await_tuple.hpp"
#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kReadBytes = 4096;
constexpr std::chrono::milliseconds kFirstWait{100};
constexpr std::chrono::milliseconds kLongestWait{2'000};

/// An open line to a lidar, which is stopped when the line is closed. It does not need the driver, which may be gone by
/// then.
class StoppedAtEnd {
public:
    StoppedAtEnd(LidarLine& line, std::vector<std::uint8_t> stop) : line_(line), stop_(std::move(stop)) {}
    StoppedAtEnd(const StoppedAtEnd&) = delete;
    StoppedAtEnd& operator=(const StoppedAtEnd&) = delete;
    ~StoppedAtEnd() { write_last(line_, stop_); }

private:
    LidarLine& line_;
    std::vector<std::uint8_t> stop_;
};

class Reading {
public:
    Reading(const LidarReaderOptions& options, LidarDriver& driver, std::function<void()> on_input)
        : options_(options), driver_(driver), on_input_(std::move(on_input)) {}

    asio::awaitable<Error> run();

private:
    [[nodiscard]] asio::awaitable<Error> read_once();
    [[nodiscard]] asio::awaitable<Result<>> take(LidarLine& line, LidarStep step);
    [[nodiscard]] asio::awaitable<Result<>> wait_for_input(LidarLine& line);
    [[nodiscard]] bool give_up(const Error& error);
    void note_packets(bool has_packet);
    [[nodiscard]] asio::awaitable<bool> is_cancelled() const;
    [[nodiscard]] Error named(const Error& error) const { return prefixed(name_of(options_.endpoint) + ": ", error); }

    const LidarReaderOptions& options_;
    LidarDriver& driver_;
    std::function<void()> on_input_;
    bool was_open_ = false;
    std::optional<Clock::time_point> gone_since_;
    std::chrono::milliseconds wait_ = kFirstWait;
    Clock::time_point byte_at_{};             ///< when the line was opened or the newest bytes arrived
    std::optional<Clock::time_point> due_at_; ///< when the driver's timeout is over
    Clock::time_point packet_at_{};
    bool foreign_reported_ = false; ///< bytes that are not packets were reported
    std::array<std::uint8_t, kReadBytes> buffer_{};
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
    auto line = co_await open_line(options_.endpoint, options_.serial, options_.silent_max);
    if (!line) co_return line.error();
    was_open_ = true;
    byte_at_ = packet_at_ = Clock::now();
    due_at_.reset();
    foreign_reported_ = false;
    const StoppedAtEnd stopped(*line, driver_.stop_request());
    Result<> going_on = co_await take(*line, driver_.on_open());
    while (going_on) {
        going_on = co_await wait_for_input(*line);
        // A device that always has bytes does not let the cancellation interrupt a read.
        if (co_await is_cancelled()) co_return Error{Errc::kShuttingDown, "cancelled"};
    }
    co_return named(going_on.error());
}

/// Does what the driver wants.
asio::awaitable<Result<>> Reading::take(LidarLine& line, LidarStep step) {
    for (const auto& note : step.notes) options_.note(name_of(options_.endpoint) + ": " + note);
    if (step.failure) co_return *step.failure;
    if (step.timeout) {
        due_at_ = step.timeout->count() > 0 ? std::optional(Clock::now() + *step.timeout) : std::nullopt;
    }
    if (step.send.empty()) co_return Result<>{};
    co_return co_await write_all(line, step.send, options_.silent_max);
}

/// Waits for bytes or for the end of a timeout, and passes them to the driver.
asio::awaitable<Result<>> Reading::wait_for_input(LidarLine& line) {
    const auto until = [](Clock::time_point time) {
        return std::chrono::ceil<std::chrono::milliseconds>(std::max(time - Clock::now(), Clock::duration::zero()));
    };
    auto wait = until(byte_at_ + options_.silent_max);
    if (due_at_) wait = std::min(wait, until(*due_at_));
    const auto count = co_await read_some(line, buffer_, wait);
    if (!count) co_return count.error();
    if (*count) {
        byte_at_ = Clock::now();
        auto step = driver_.on_bytes(std::span<const std::uint8_t>(buffer_).first(**count), unix_now());
        note_packets(step.has_packet);
        on_input_();
        if (auto taken = co_await take(line, std::move(step)); !taken) co_return taken;
    }
    if (due_at_ && Clock::now() >= *due_at_) { // also while foreign bytes arrive all the time
        due_at_.reset();
        co_return co_await take(line, driver_.on_timeout());
    }
    if (Clock::now() - byte_at_ < options_.silent_max) co_return Result<>{};
    co_return Error{Errc::kTimeout, fmt::format("no byte for {:g} s; check that the sensor has power and turns",
                                                seconds(options_.silent_max))};
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

void Reading::note_packets(bool has_packet) {
    const auto now = Clock::now();
    if (has_packet) {
        if (gone_since_) options_.note(name_of(options_.endpoint) + ": packets are received again");
        gone_since_.reset();
        wait_ = kFirstWait;
        packet_at_ = now;
        foreign_reported_ = false;
    } else if (!foreign_reported_ && now - packet_at_ >= options_.silent_max) {
        foreign_reported_ = true;
        options_.note(fmt::format("{}: bytes without any packet of {} for {:g} s; is it another device, or a line "
                                  "speed other than {} baud?",
                                  name_of(options_.endpoint), driver_.title(), seconds(options_.silent_max),
                                  options_.serial.baud));
    }
}

asio::awaitable<bool> Reading::is_cancelled() const {
    co_return (co_await asio::this_coro::cancellation_state).cancelled() != asio::cancellation_type::none;
}

} // namespace

asio::awaitable<Error> read_lidar(LidarReaderOptions options, LidarDriver& driver, std::function<void()> on_input) {
    co_return co_await Reading(options, driver, std::move(on_input)).run();
}

} // namespace scanloom::robot
