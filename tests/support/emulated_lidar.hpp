#pragma once

#include "common/net/await_tuple.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "tests/support/lidar_emulators.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/write.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <span>
#include <utility>

namespace scanloom::testing_support {

/// An emulator on a line. Requests are taken also while the line is full of measurements that no program reads.
template <class Line>
class EmulatedLidar {
public:
    EmulatedLidar(Line line, std::shared_ptr<LidarEmulator> emulator, std::chrono::milliseconds period)
        : line_(std::move(line)), emulator_(std::move(emulator)), period_(period) {}

    boost::asio::awaitable<void> take_requests() {
        std::array<std::uint8_t, 1024> buffer{};
        for (;;) {
            const auto [failed, count] = co_await line_.async_read_some(boost::asio::buffer(buffer), kAwaitTuple);
            if (failed) co_return;
            const auto answers = emulator_->receive(std::span(buffer).first(count));
            answers_.insert(answers_.end(), answers.begin(), answers.end());
            wake_.notify();
        }
    }

    boost::asio::awaitable<void> send() {
        auto next_turn = std::chrono::steady_clock::now();
        for (;;) {
            auto bytes = std::exchange(answers_, {});
            if (bytes.empty() && emulator_->is_measuring() && std::chrono::steady_clock::now() >= next_turn) {
                bytes = emulator_->next_turn();
                next_turn += period_;
            }
            if (bytes.empty()) {
                const auto until = emulator_->is_measuring() ? next_turn : robot::WakeSignal::Time::max();
                co_await wake_.wait(until);
                next_turn = std::max(next_turn, std::chrono::steady_clock::now());
                continue;
            }
            if (std::get<0>(co_await boost::asio::async_write(line_, boost::asio::buffer(bytes), kAwaitTuple)))
                co_return;
        }
    }

private:
    Line line_;
    std::shared_ptr<LidarEmulator> emulator_;
    std::chrono::milliseconds period_;
    LidarEmulator::Bytes answers_;
    robot::WakeSignal wake_;
};

/// Runs an emulator on a line until its other end is closed.
/// @param line    the sensor's end: a connected socket, or a terminal
/// @param period  of a turn; 0: as fast as the program reads
template <class Line>
boost::asio::awaitable<void> emulate(Line line, std::shared_ptr<LidarEmulator> emulator,
                                     std::chrono::milliseconds period = std::chrono::milliseconds(0)) {
    using namespace boost::asio::experimental::awaitable_operators;
    EmulatedLidar<Line> lidar(std::move(line), std::move(emulator), period);
    co_await (lidar.take_requests() || lidar.send());
}

} // namespace scanloom::testing_support
