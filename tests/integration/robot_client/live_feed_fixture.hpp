#pragma once

#include "robot_client/uplink/live_feed.hpp"
#include "robot_client/uplink/uplink.hpp"
#include "tests/integration/robot_client/fake_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// A source that returns its scans as fast as they are taken, then waits until the test continues, ends or fails it.
class ScriptedSource final : public LiveSource {
public:
    asio::awaitable<Result<std::optional<Observation>>> next() override {
        const auto wake = std::make_shared<asio::steady_timer>(co_await asio::this_coro::executor,
                                                               asio::steady_timer::time_point::max());
        wake_ = wake;
        for (;;) {
            if (given_ < allowed_) {
                ++given_;
                on_given(given_);
                co_await asio::post(co_await asio::this_coro::executor, asio::use_awaitable); // lets other tasks run
                co_return std::optional(scan(given_));
            }
            if (fails_) co_return Error{Errc::kStoreFailed, "the sensor failed"};
            if (ended_) co_return std::optional<Observation>{};
            co_await wake->async_wait(asio::as_tuple(asio::use_awaitable));
        }
    }
    void stop() override { end(); }

    [[nodiscard]] bool can_wait() const override { return can_wait_; }
    void resume_after(std::uint64_t scans) override { resumed_after_ = scans; }

    void allow(std::uint64_t upto) {
        allowed_ = upto;
        wake();
    }
    void end() {
        ended_ = true;
        wake();
    }
    void fail() {
        fails_ = true;
        wake();
    }

    std::function<void(std::uint64_t)> on_given = [](std::uint64_t) {};
    std::uint64_t given_ = 0;
    bool can_wait_ = false;
    std::uint64_t large_from_ = UINT64_MAX; ///< ten times the beams
    std::optional<std::uint64_t> resumed_after_;

private:
    void wake() {
        if (const auto wake = wake_.lock()) wake->cancel();
    }
    Observation scan(std::uint64_t number) const {
        Observation made{sensor_, {}};
        made.scan.pose = {static_cast<double>(number), 0.0, 0.0};
        made.scan.ranges.assign(number < large_from_ ? 90 : 900, 1000);
        return made;
    }

    std::weak_ptr<asio::steady_timer> wake_; // of next(), while it waits
    std::shared_ptr<const Sensor> sensor_ = std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 90}, 0.0, 0.0, 10.0});
    std::uint64_t allowed_ = 0;
    bool ended_ = false;
    bool fails_ = false;
};

class LiveFeedTest : public testing::Test {
protected:
    LiveFeedTest() {
        options_.on_message = [this](const std::string& text) { warnings_.push_back(text); };
    }

    UplinkOptions uplink_options() {
        UplinkOptions made;
        made.servers = {{"127.0.0.1", std::to_string(server_.port())}};
        made.protocol.hello.robot = "r1";
        made.protocol.hello.session = "s1";
        made.buffer_bytes_max = 100'000;
        made.give_up_after = 0ms;
        made.give_up_after_end = 20s;
        return made;
    }

    std::unique_ptr<Spool> spool(std::uint64_t bytes_max = 64 << 20) {
        return Spool::open({directory_.path() / "spool", bytes_max, WhenFull::kDropOldest}, options_.on_message)
            .value();
    }

    /// Runs a program until it ends or is killed; `meanwhile` is called when everything is set up.
    Result<> run(
        LiveSource& source, std::unique_ptr<Spool> spool, const std::function<void()>& meanwhile = [] {}) {
        asio::io_context robot(1);
        LiveFeed feed(source, std::move(spool), options_);
        Uplink uplink(robot, uplink_options(), feed);
        uplink_ = &uplink;
        is_killed_ = false;
        Result<> outcome = Error{Errc::kInternal, "killed"};
        asio::co_spawn(robot, uplink.run(), [&](std::exception_ptr failed, Result<> result) {
            EXPECT_FALSE(failed);
            outcome = std::move(result);
            robot.stop();
        });
        asio::post(robot, meanwhile);
        while (!robot.stopped() && !is_killed_) {
            robot.poll_one();
            server_io_.restart();
            server_io_.poll();
        }
        status_ = uplink.status();
        return outcome;
    }

    /// Waits until nothing of the program runs.
    void kill() { is_killed_ = true; }

    [[nodiscard]] std::ptrdiff_t spool_files() const {
        const auto is_segment = [](const auto& entry) { return entry.path().extension() == ".spool"; };
        return std::ranges::count_if(std::filesystem::directory_iterator(directory_.path() / "spool"), is_segment);
    }

    void expect_stored(std::uint64_t scans) {
        EXPECT_THAT(server_.faults(), testing::IsEmpty());
        ASSERT_EQ(server_.stored().size(), scans);
        for (std::uint64_t i = 0; i < scans; ++i) EXPECT_EQ(server_.stored()[i].pose->x, static_cast<double>(i + 1));
    }

    asio::io_context server_io_{1};
    TemporaryDirectory directory_;
    FakeServer server_{server_io_, {{}}};
    LiveFeedOptions options_;
    Uplink* uplink_ = nullptr;
    bool is_killed_ = false;
    UplinkStatus status_;
    std::vector<std::string> warnings_;
};

} // namespace scanloom::robot
