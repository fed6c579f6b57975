#include "robot_client/sources/locating_source.hpp"

#include "robot_client/sources/live_source.hpp"
#include "tests/support/recorded_source.hpp"
#include "tests/unit/robot_client/sources/carried_lidar.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

namespace scanloom::robot {
namespace {

namespace asio = boost::asio;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Given = Result<std::optional<Observation>>;

const LocateResult kFound{{3.0, 4.0, 1.0}, 0.93, 0.02, 0.01};
const Error kUnknownPlace{Errc::kUndetermined, "too little of this is in the map"};

/// Gives recorded turns, then waits for stop().
class WaitingLidar final : public LiveSource {
public:
    explicit WaitingLidar(std::vector<Observation> turns) : turns_(std::move(turns)) {}

    asio::awaitable<Given> next() override {
        const auto timer = std::make_shared<asio::steady_timer>(co_await asio::this_coro::executor,
                                                                asio::steady_timer::time_point::max());
        timer_ = timer;
        if (given_ == turns_.size() && !is_stopped_) co_await timer->async_wait(asio::as_tuple(asio::use_awaitable));
        if (is_stopped_) co_return std::optional<Observation>{};
        co_return std::optional(turns_[given_++]);
    }
    void stop() override {
        is_stopped_ = true;
        if (const auto timer = timer_.lock()) timer->cancel();
    }

private:
    std::vector<Observation> turns_;
    std::size_t given_ = 0;
    bool is_stopped_ = false;
    std::weak_ptr<asio::steady_timer> timer_;
};

class LocatingSourceTest : public testing::Test {
protected:
    LocatingSource::Report record_messages() {
        return [this](const std::string& text) { messages_.push_back(text); };
    }

    LocatingSource replayed(std::vector<Observation> turns) {
        auto recording = std::make_unique<RecordedSource>(std::move(turns));
        return {std::make_unique<ReplayedSource>(std::move(recording)), Pose2{1.0, 2.0, 0.5}, record_messages(),
                std::chrono::milliseconds(0)};
    }

    /// Returns a callback that gives the answers in order and repeats the last one.
    Locate answers(std::vector<Result<LocateResult>> all) {
        return [this, all](std::vector<PointMm> points, Point2 from) -> asio::awaitable<Result<LocateResult>> {
            return answer(all[std::min(requests_++, all.size() - 1)], points.size(), from);
        };
    }

    asio::awaitable<Result<LocateResult>> answer(Result<LocateResult> located, std::size_t points, Point2 from) {
        EXPECT_GE(points, 3000U);
        EXPECT_EQ(from, (Point2{0.0, 0.0}));
        co_return located;
    }

    /// Returns a callback that never answers.
    Locate never_answers() {
        return [this](std::vector<PointMm>, Point2) { return wait_forever(); };
    }

    asio::awaitable<Result<LocateResult>> wait_forever() {
        ++requests_;
        asio::steady_timer never(co_await asio::this_coro::executor, asio::steady_timer::time_point::max());
        co_await never.async_wait(asio::use_awaitable);
        co_return kFound;
    }

    Given next(
        LiveSource& source, const std::function<void()>& meanwhile = [] {}) {
        std::optional<Given> given;
        asio::co_spawn(io_, source.next(), [&](std::exception_ptr failed, Given result) {
            if (failed) std::rethrow_exception(failed);
            given = std::move(result);
        });
        io_.restart();
        io_.poll();
        meanwhile();
        io_.poll();
        return given.value_or(Error{Errc::kInternal, "next() did not end"});
    }

    std::vector<Pose2> poses_of(LiveSource& source) {
        std::vector<Pose2> poses;
        for (outcome_ = next(source); outcome_ && *outcome_; outcome_ = next(source)) {
            poses.push_back(*(**outcome_).scan.pose);
        }
        return poses;
    }

    static void append(std::vector<Observation>& turns, std::vector<Observation> more) {
        for (auto& turn : more) turns.push_back(std::move(turn));
    }

    asio::io_context io_{1};
    CarriedLidar lidar_;
    std::size_t requests_ = 0;
    std::vector<std::string> messages_;
    Given outcome_ = std::optional<Observation>{};
};

TEST_F(LocatingSourceTest, LocatedTurnsHaveTheLocatedPose) {
    auto turns = lidar_.turns_at(kHere, 20);
    append(turns, lidar_.turns_between(kHere, kThere, 30));
    append(turns, lidar_.turns_at(kThere, 20));
    auto source = replayed(turns);
    const LocateResult second{{7.0, 8.0, -1.0}, 0.8, 0.02, 0.01};
    source.ask_with(answers({Error{Errc::kNothingMapped, "nothing is mapped"}, second}));
    const auto poses = poses_of(source);
    ASSERT_TRUE(outcome_);
    ASSERT_EQ(poses.size(), 17U + 20U);
    for (std::size_t n = 0; n < poses.size(); ++n) {
        EXPECT_EQ(poses[n], n < 17 ? (Pose2{1.0, 2.0, 0.5}) : second.T_map_odom) << n;
    }
    EXPECT_EQ(requests_, 2U);
    EXPECT_EQ(source.remarks(), "carried 1 time, 33 turns while carried or not localized");
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("assumed to be (1.00, 2.00)"), HasSubstr("the lidar was moved"),
                                       HasSubstr("localized at (7.00, 8.00)")));
}

TEST_F(LocatingSourceTest, TurnsOfARefusedPlaceAreDropped) {
    auto source = replayed(lidar_.turns_at(kHere, 150));
    source.ask_with(answers({kUnknownPlace}));
    EXPECT_THAT(poses_of(source), IsEmpty());
    ASSERT_FALSE(outcome_);
    EXPECT_EQ(outcome_.error(), (Error{kUnknownPlace.code, "no scan was sent: " + kUnknownPlace.message}));
    EXPECT_EQ(requests_, 2U);
    EXPECT_EQ(messages_.size(), 1U);
    EXPECT_EQ(source.remarks(), "carried 0 times, 150 turns while carried or not localized");
}

TEST_F(LocatingSourceTest, RepeatsTheRequestIfTheServerIsOverloaded) {
    auto source = replayed(lidar_.turns_at(kHere, 20));
    const Error busy{Errc::kOverloaded, "too many requests of robots are waiting at this moment; try again soon"};
    source.ask_with(answers({busy, Error{Errc::kShuttingDown, "the server is shutting down"}, busy, kFound}));
    EXPECT_EQ(poses_of(source).size(), 20U);
    EXPECT_TRUE(outcome_);
    EXPECT_EQ(requests_, 4U);
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("keep the lidar in place; retrying"), HasSubstr("localized at")));
    EXPECT_EQ(source.remarks(), "carried 0 times, 0 turns while carried or not localized");
}

TEST_F(LocatingSourceTest, StopEndsTheWaitBeforeARetry) {
    LocatingSource source(std::make_unique<WaitingLidar>(lidar_.turns_at(kHere, 20)), {}, record_messages(),
                          std::chrono::hours(1));
    source.ask_with(
        answers({Error{Errc::kOverloaded, "too many requests of robots are waiting at this moment; try again soon"}}));
    const Given given = next(source, [&] { source.stop(); });
    EXPECT_EQ(requests_, 1U);
    EXPECT_EQ(given.error().code, Errc::kNotFound);
}

TEST_F(LocatingSourceTest, ReportsThatTheLidarWasNeverStationary) {
    auto source = replayed(lidar_.turns_between(kHere, kThere, 40));
    source.ask_with(answers({kFound}));
    EXPECT_THAT(poses_of(source), IsEmpty());
    ASSERT_FALSE(outcome_);
    EXPECT_THAT(outcome_.error().message, HasSubstr("among 40 turns no 10 in a row were similar"));
    EXPECT_EQ(requests_, 0U);
}

TEST_F(LocatingSourceTest, StopEndsAPendingRequest) {
    LocatingSource source(std::make_unique<WaitingLidar>(lidar_.turns_at(kHere, 20)), {}, record_messages());
    source.ask_with(never_answers());
    const Given given = next(source, [&] { source.stop(); });
    EXPECT_EQ(requests_, 1U);
    ASSERT_FALSE(given);
    EXPECT_EQ(given.error().code, Errc::kNotFound);
    EXPECT_THAT(given.error().message, HasSubstr("stopped before the server had localized the lidar"));
}

TEST_F(LocatingSourceTest, StopWhileStationaryGivesTheHeldTurns) {
    LocatingSource source(std::make_unique<WaitingLidar>(lidar_.turns_at(kHere, 12)), {}, record_messages());
    source.ask_with(answers({kFound}));
    for (int n = 0; n < 9; ++n) EXPECT_TRUE(next(source).value());
    const Given tenth = next(source, [&] { source.stop(); });
    ASSERT_TRUE(tenth && *tenth);
    EXPECT_EQ(poses_of(source).size(), 2U);
    EXPECT_TRUE(outcome_) << outcome_.error().message;
}

TEST_F(LocatingSourceTest, StopBeforeTheStartGivesNothing) {
    LocatingSource source(std::make_unique<WaitingLidar>(lidar_.turns_at(kHere, 12)), {}, record_messages());
    source.ask_with(never_answers());
    source.stop();
    const Given given = next(source);
    ASSERT_TRUE(given);
    EXPECT_FALSE(*given);
}

TEST_F(LocatingSourceTest, FailingLidarEndsTheSourceAndDropsHeldTurns) {
    auto recording = std::make_unique<RecordedSource>(lidar_.turns_at(kHere, 20));
    recording->fail_after(15);
    LocatingSource source(std::make_unique<ReplayedSource>(std::move(recording)), {}, record_messages());
    source.ask_with(answers({kFound}));
    EXPECT_EQ(poses_of(source).size(), 12U);
    ASSERT_FALSE(outcome_);
    EXPECT_THAT(outcome_.error().message, HasSubstr("the rest of the recording cannot be read"));
}

TEST_F(LocatingSourceTest, CanWaitOnlyForARecording) {
    auto source = replayed({});
    EXPECT_TRUE(source.can_wait());
    LocatingSource live(std::make_unique<WaitingLidar>(std::vector<Observation>{}), {}, record_messages());
    EXPECT_FALSE(live.can_wait());
}

} // namespace
} // namespace scanloom::robot
