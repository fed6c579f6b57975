#include "sim/robot/exploring_source.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <exception>
#include <utility>

namespace scanloom::sim {
namespace {

namespace asio = boost::asio;
using Given = Result<std::optional<robot::Observation>>;

constexpr int kFirstTurnScansMax = 42; // upper bound for the scans of the first full turn

class ExploringSourceTest : public testing::Test {
protected:
    static ExploringSource make(SimulationLimits limits = {}, double speed = 0.0) {
        return {{make_room(), *find_laser("lidar360"), std::nullopt, 3, Pose2{-3.5, -3.5, 0.0}},
                limits,
                robot::NoReturn::kFree,
                speed};
    }

    /// Returns a callback that gives the answers in order and counts the requests.
    robot::NextGoal answers(std::vector<Result<robot::NextStop>> all) {
        return [this, all = std::move(all)]() -> asio::awaitable<Result<robot::NextStop>> {
            const std::size_t n = requests_++;
            EXPECT_LT(n, all.size());
            co_return n < all.size() ? all[n] : Result<robot::NextStop>(robot::NextStop{});
        };
    }

    Given next(ExploringSource& source) {
        std::optional<Given> given;
        asio::co_spawn(io_, source.next(), [&](std::exception_ptr failed, Given result) {
            if (failed) std::rethrow_exception(failed);
            given = std::move(result);
        });
        io_.restart();
        io_.run();
        return given.value_or(Error{Errc::kInternal, "next() did not end"});
    }

    std::vector<Scan> all_of(ExploringSource& source) {
        std::vector<Scan> scans;
        for (Given given = next(source); given && *given; given = next(source)) scans.push_back((**given).scan);
        return scans;
    }

    static robot::NextStop goal(std::vector<Point2> path, const Point2& target) {
        robot::NextStop stop;
        stop.outcome = robot::NextStop::Outcome::kGoal;
        stop.path = std::move(path);
        stop.target = target;
        return stop;
    }

    static robot::NextStop taken() {
        robot::NextStop stop;
        stop.outcome = robot::NextStop::Outcome::kTakenByOthers;
        return stop;
    }

    asio::io_context io_;
    std::size_t requests_ = 0;
};

TEST_F(ExploringSourceTest, RequestsGoalsAfterObservingAndEndsWhenExplored) {
    auto source = make();
    source.ask_with(answers({goal({{-3.5, -3.5}, {-3.5, -1.5}}, {-3.5, 0.0}), robot::NextStop{}}));
    const auto scans = all_of(source);
    EXPECT_EQ(requests_, 2U);
    ASSERT_GT(scans.size(), 70U);
    EXPECT_LT(std::hypot(scans.back().pose->x + 3.5, scans.back().pose->y + 1.5), 0.05)
        << "the scan at the goal is given before the next request";
    EXPECT_LT(std::abs(scans.back().pose->yaw - 1.5708), 0.05);
    for (std::size_t n = 0; n < scans.size(); ++n) EXPECT_NEAR(scans[n].stamp, 0.1 * static_cast<double>(n), 1e-9);
    EXPECT_TRUE(
        source.remarks().starts_with("explored: no frontier is reachable with a clearance of 0.22 m, 2 m driven in "))
        << source.remarks();
    EXPECT_FALSE(*next(source)) << "the source stays ended";
}

TEST_F(ExploringSourceTest, TakenGoalsAreRequestedAgainAfterOneSecond) {
    auto source = make();
    source.ask_with(answers({taken(), taken(), robot::NextStop{}}));
    const auto scans = all_of(source);
    EXPECT_EQ(requests_, 3U);
    EXPECT_LE(scans.size(), kFirstTurnScansMax + 20U);
    EXPECT_GE(scans.size(), kFirstTurnScansMax + 18U);
}

TEST_F(ExploringSourceTest, ErrorsAreRetriedUntilTheTenthInARow) {
    const Error refused{Errc::kOverloaded, "no time for this now"};
    auto source = make();
    std::vector<Result<robot::NextStop>> all(9, refused);
    all.emplace_back(taken()); // therefore the errors are not ten in a row
    all.insert(all.end(), 10, refused);
    source.ask_with(answers(all));
    Given given = next(source);
    while (given && *given) given = next(source);
    ASSERT_FALSE(given);
    EXPECT_EQ(given.error(), refused);
    EXPECT_EQ(requests_, 20U);
}

TEST_F(ExploringSourceTest, EndsIfEveryGoalIsBlocked) {
    auto source = make();
    source.ask_with([this]() -> asio::awaitable<Result<robot::NextStop>> {
        ++requests_;
        co_return goal({{-3.5, -3.5}, {-9.0, -9.0}}, {-9.0, -9.0}); // through the walls of a corner
    });
    Given given = next(source);
    while (given && *given) given = next(source);
    ASSERT_FALSE(given);
    EXPECT_EQ(given.error().code, Errc::kNoPath);
    EXPECT_EQ(source.simulator().collisions(), 0U);
    EXPECT_LT(requests_, 100U);
}

TEST_F(ExploringSourceTest, ALostRobotLeavesItsPathLooksAroundAndAsksAgain) {
    auto source = make();
    source.ask_with(answers({goal({{-3.5, -3.5}, {-3.5, 3.5}}, {-3.5, 3.6}), robot::NextStop{}}));
    while (source.simulator().pose().y < -2.0) ASSERT_TRUE(*next(source));
    source.correct({0.0, 0.0, 0.0}, LocalizationState::kLost);
    const auto lost_at = source.simulator().pose();
    const auto scans = all_of(source);
    EXPECT_EQ(requests_, 2U);
    EXPECT_GT(scans.size(), kFirstTurnScansMax / 2U) << "a full turn";
    for (const Scan& scan : scans) {
        EXPECT_LT(std::hypot(scan.pose->x - lost_at.x, scan.pose->y - lost_at.y), 0.2) << "it does not drive on";
    }
}

TEST_F(ExploringSourceTest, LimitsIncludeEarlierRuns) {
    auto source = make({.scans = 30});
    source.resume_after(20);
    source.ask_with(answers({}));
    const auto scans = all_of(source);
    ASSERT_EQ(scans.size(), 10U);
    EXPECT_NEAR(scans.front().stamp, 2.0, 1e-9) << "the scans follow those of the earlier run";
    EXPECT_NEAR(scans.back().stamp, 2.9, 1e-9);
}

TEST_F(ExploringSourceTest, StopDuringARequestEndsTheSource) {
    auto source = make();
    bool needs_goal = false;
    source.ask_with([&]() -> asio::awaitable<Result<robot::NextStop>> {
        needs_goal = true;
        asio::steady_timer never(co_await asio::this_coro::executor, asio::steady_timer::time_point::max());
        co_await never.async_wait(asio::use_awaitable);
        co_return robot::NextStop{};
    });
    std::optional<Given> last;
    int scans = 0;
    asio::co_spawn(
        io_,
        [&]() -> asio::awaitable<void> {
            for (;;) {
                last = co_await source.next();
                if (!*last || !**last) co_return;
                ++scans;
            }
        },
        asio::detached);
    while (!needs_goal) io_.run_one();
    source.stop();
    io_.run();
    ASSERT_TRUE(last && *last);
    EXPECT_FALSE(**last);
    EXPECT_LE(scans, kFirstTurnScansMax);
    EXPECT_FALSE(*next(source));
}

TEST_F(ExploringSourceTest, ScansAreIndependentOfTheSpeed) {
    const std::vector<Result<robot::NextStop>> all{goal({{-3.5, -3.5}, {-3.5, -3.0}}, {-3.5, 0.0}), robot::NextStop{}};
    auto first = make();
    first.ask_with(answers(all));
    const auto scans = all_of(first);
    requests_ = 0;
    auto second = make({}, 1e6);
    second.ask_with(answers(all));
    EXPECT_EQ(all_of(second), scans);
}

} // namespace
} // namespace scanloom::sim
