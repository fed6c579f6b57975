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

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

namespace scanloom::robot {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

/// Gives its scans as fast as they are taken, then rests until it is told to go on, to end or to fail.
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
                co_await asio::post(co_await asio::this_coro::executor, asio::use_awaitable); // others have their turn
                co_return std::optional(scan(given_));
            }
            if (fails_) co_return Error{Errc::kStoreFailed, "the sensor is gone"};
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
    std::optional<std::uint64_t> resumed_after_;

private:
    void wake() {
        if (const auto wake = wake_.lock()) wake->cancel();
    }
    Observation scan(std::uint64_t number) const {
        Observation made{sensor_, {}};
        made.scan.pose.x = static_cast<double>(number);
        made.scan.ranges.assign(90, 1000);
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
        options_.tell = [this](const std::string& text) { told_.push_back(text); };
    }

    UplinkOptions uplink_options() {
        UplinkOptions made;
        made.server.host = "127.0.0.1";
        made.server.port = std::to_string(server_.port());
        made.conversation.hello.robot = "r1";
        made.conversation.hello.session = "s1";
        made.conversation.buffer_bytes_max = 100'000;
        made.give_up_after = 0ms;
        made.give_up_after_end = 20s;
        return made;
    }

    std::unique_ptr<Spool> spool(std::uint64_t bytes_max = 64 << 20) {
        return Spool::open({directory_.path() / "spool", bytes_max, WhenFull::kDropOldest}, options_.tell).value();
    }

    /// A program from its start to its end, or until it is killed; `meanwhile` is called once all is set up.
    Result<> run(
        ScriptedSource& source, std::unique_ptr<Spool> spool, const std::function<void()>& meanwhile = [] {}) {
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

    /// Nothing of the program runs any more.
    void kill() { is_killed_ = true; }

    void expect_stored(std::uint64_t scans) {
        EXPECT_THAT(server_.faults(), IsEmpty());
        ASSERT_EQ(server_.stored().size(), scans);
        for (std::uint64_t i = 0; i < scans; ++i) EXPECT_EQ(server_.stored()[i].pose.x, static_cast<double>(i + 1));
    }

    asio::io_context server_io_{1};
    TemporaryDirectory directory_;
    FakeServer server_{server_io_, {{}}};
    LiveFeedOptions options_;
    Uplink* uplink_ = nullptr;
    bool is_killed_ = false;
    UplinkStatus status_;
    std::vector<std::string> told_;
};

TEST_F(LiveFeedTest, CarriesWhatASensorGivesUntilItEnds) {
    for (const bool spooled : {false, true}) {
        ScriptedSource source;
        source.allow(100);
        source.end();
        server_.forget();
        const auto outcome = run(source, spooled ? spool() : nullptr);
        EXPECT_TRUE(outcome) << outcome.error().message;
        expect_stored(100);
    }
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(LiveFeedTest, WithoutAServerASpoolTakesAllAndGivesThemWhenThereIsOne) {
    server_.close();
    ScriptedSource source;
    source.on_given = [&](std::uint64_t given) {
        if (given != 5000) return;
        EXPECT_EQ(uplink_->status().dropped, 0U);
        EXPECT_GE(uplink_->status().waiting, 4990U);
        server_.reopen();
        source.end();
    };
    source.allow(5000);
    const auto outcome = run(source, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(5000);
}

TEST_F(LiveFeedTest, WithoutASpoolTheOldestUnsentGoWhenMemoryIsFullAndThatIsTold) {
    server_.close();
    ScriptedSource source;
    source.on_given = [&](std::uint64_t given) {
        if (given != 1000) return;
        server_.reopen();
        source.end();
    };
    source.allow(1000);
    EXPECT_TRUE(run(source, nullptr));
    const auto kept = server_.stored().size();
    EXPECT_LT(kept, 300U);
    EXPECT_GT(kept, 100U);
    EXPECT_EQ(status_.dropped, 1000 - kept);
    EXPECT_EQ(server_.stored().back().pose.x, 1000.0);
    EXPECT_THAT(server_.faults(), IsEmpty()) << "numbers have no gaps";
    EXPECT_THAT(told_, testing::ElementsAre(HasSubstr("--spool keeps them on disk")));
}

TEST_F(LiveFeedTest, AKilledProgramsScansAreSentByTheNextOnce) {
    // Each is killed at another moment: with nothing sent, with some under way, with some acknowledged.
    std::uint64_t taken = 0;
    for (const std::uint64_t until : {50U, 137U, 300U, 301U, 900U}) {
        if (until == 50) server_.close();
        ScriptedSource source;
        source.given_ = taken;
        source.on_given = [&](std::uint64_t given) {
            if (given == until) kill();
            taken = given - 1; // this one was never given
        };
        source.allow(until);
        EXPECT_EQ(run(source, spool()).error().message, "killed");
        if (until == 50) server_.reopen();
    }
    ScriptedSource last;
    last.given_ = taken;
    last.allow(1000);
    last.end();
    EXPECT_TRUE(run(last, spool()));
    expect_stored(1000);
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(LiveFeedTest, ASpoolIsLeftEmptyByAnEndLongBehindTheLastAck) {
    ScriptedSource source;
    source.allow(40);
    const std::function<void()> end_once_all_is_acknowledged = [&] {
        if (uplink_->status().acknowledged == 40) return source.end();
        asio::post(uplink_->executor(), end_once_all_is_acknowledged);
    };
    EXPECT_TRUE(run(source, spool(), end_once_all_is_acknowledged));
    const auto is_segment = [](const auto& entry) { return entry.path().extension() == ".spool"; };
    EXPECT_EQ(std::ranges::count_if(std::filesystem::directory_iterator(directory_.path() / "spool"), is_segment), 0);
}

TEST_F(LiveFeedTest, StoppedWithoutAServerItSaysWhatWaitsAndTheNextSendsIt) {
    server_.close();
    {
        ScriptedSource source;
        source.on_given = [&](std::uint64_t given) {
            if (given == 20) uplink_->stop();
        };
        source.allow(20);
        const auto outcome = run(source, spool());
        ASSERT_FALSE(outcome);
        EXPECT_THAT(outcome.error().message, HasSubstr("scans in the spool"));
    }
    server_.reopen();
    ScriptedSource next;
    next.end();
    EXPECT_TRUE(run(next, spool()));
    EXPECT_GE(server_.stored().size(), 19U);
    EXPECT_THAT(server_.faults(), IsEmpty());
}

TEST_F(LiveFeedTest, ASensorThatFailsIsAnErrorOnceWhatItGaveIsStored) {
    for (const bool spooled : {false, true}) {
        ScriptedSource source;
        source.allow(30);
        source.fail();
        server_.forget();
        const auto outcome = run(source, spooled ? spool() : nullptr);
        ASSERT_FALSE(outcome);
        EXPECT_EQ(outcome.error().message, "the sensor is gone");
        expect_stored(30);
    }
}

TEST_F(LiveFeedTest, ASourceThatCanWaitIsAskedOnlyWhileThereIsRoomAndNothingIsLost) {
    server_.close();
    ScriptedSource source;
    source.can_wait_ = true;
    source.allow(1000);
    source.end();
    const auto outcome = run(source, nullptr, [&] {
        EXPECT_EQ(source.given_, 0U) << "there is no server yet";
        server_.reopen();
    });
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(1000);
    EXPECT_EQ(source.resumed_after_, 0U);
}

TEST_F(LiveFeedTest, WhatIsAppliedCanBeWaitedFor) {
    ScriptedSource source;
    source.allow(40);
    std::uint64_t stored_when_applied = 0;
    source.on_given = [&](std::uint64_t given) {
        if (given != 40) return;
        asio::co_spawn(uplink_->executor(), uplink_->until_applied(), [&](std::exception_ptr) {
            stored_when_applied = server_.stored().size();
            source.end();
        });
    };
    EXPECT_TRUE(run(source, spool()));
    EXPECT_GE(stored_when_applied, 39U) << "the fortieth is on its way to the feed";
}

/// Files may not grow beyond some bytes while this is there, as if the disk were full.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit full{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &full);
    }
    ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

TEST_F(LiveFeedTest, ADiskThatIsFullFromTheBeginningHoldsUpNothing) {
    FullDisk full(0);
    ScriptedSource source;
    source.allow(100);
    source.end();
    const auto outcome = run(source, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(100);
    EXPECT_THAT(told_, testing::ElementsAre(HasSubstr("File too large; scans are held in memory only")));
}

TEST_F(LiveFeedTest, WhatASpoolHoldsIsSentAlsoWhereTheDiskIsFullByNow) {
    server_.close();
    {
        ScriptedSource source;
        source.on_given = [&](std::uint64_t given) {
            if (given == 600) kill();
        };
        source.allow(600);
        EXPECT_FALSE(run(source, spool()));
    }
    FullDisk full(300); // no file may become larger; what stands in their first bytes may change
    server_.reopen();
    ScriptedSource next;
    next.end();
    const auto outcome = run(next, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(599);
}

TEST_F(LiveFeedTest, ASpoolThatCannotBeWrittenIsToldAndTheLinkGoesOnWithoutIt) {
    std::optional<FullDisk> full;
    ScriptedSource source;
    server_.on_stored = [&](std::size_t stored) {
        if (stored != 10) return;
        full.emplace(300);
        source.allow(100);
        source.end();
    };
    source.allow(10);
    const auto outcome = run(source, spool());
    full.reset();
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(100);
    EXPECT_THAT(told_, testing::ElementsAre(HasSubstr("File too large; scans are held in memory only")));
}

} // namespace
} // namespace scanloom::robot
