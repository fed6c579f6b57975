#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/locating_source.hpp"
#include "robot_client/uplink/server_requests.hpp"
#include "tests/integration/robot_client/live_feed_fixture.hpp"
#include "tests/support/recorded_source.hpp"
#include "tests/unit/robot_client/sources/carried_lidar.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>

/// A robot requests its location over a real link.
namespace scanloom::robot {
namespace {

using namespace asio::experimental::awaitable_operators;
using testing::HasSubstr;

const wire::Near kNear{{1.0, 2.0}, 5.0};
const Point2 kFirstPlace{-3.0, 4.0};

class LocationTest : public LiveFeedTest {
protected:
    void serve(LinkScript script) { server_.continue_with(std::move(script)); }

    static std::vector<PointMm> points() {
        std::vector<PointMm> made;
        for (std::int32_t n = 0; n < 25; ++n) made.push_back({n, -n});
        return made;
    }

    /// Sends a request within a run of the robot's program, and ends the run.
    asio::awaitable<void> ask(Uplink& uplink, ScriptedSource& source) {
        const Locate locate = located_by(uplink, kNear, kFirstPlace);
        answer_ = co_await locate(points(), Point2{0.5, 0.25});
        source.end();
    }

    Result<> run_and_ask(ScriptedSource& source) {
        return run(source, nullptr,
                   [&] { asio::co_spawn(uplink_->executor(), ask(*uplink_, source), [](std::exception_ptr) {}); });
    }

    /// The search areas of four requests.
    std::vector<std::optional<wire::Near>> asked_four_times() {
        ScriptedSource source;
        const auto ask_four_times = [&]() -> asio::awaitable<void> {
            const Locate locate = located_by(*uplink_, kNear, kFirstPlace);
            for (int times = 0; times < 4; ++times) static_cast<void>(co_await locate(points(), Point2{0.5, 0.25}));
            source.end();
        };
        EXPECT_TRUE(run(source, nullptr, [&] {
            asio::co_spawn(uplink_->executor(), ask_four_times(),
                           [](std::exception_ptr failed) { EXPECT_FALSE(failed); });
        }));
        std::vector<std::optional<wire::Near>> asked;
        for (const auto& request : server_.locates()) asked.push_back(request.near);
        return asked;
    }

    std::optional<Result<LocateResult>> answer_;
};

TEST_F(LocationTest, IsTheServersAnswer) {
    serve({.location = wire::Correction{{1.0, 2.0, 3.0}, 7, 0.9, 0.01, 0.02}});
    ScriptedSource source;
    ASSERT_TRUE(run_and_ask(source));
    ASSERT_TRUE(answer_ && *answer_);
    EXPECT_EQ((*answer_)->T_map_odom, (Pose2{1.0, 2.0, 3.0}));
    EXPECT_EQ((*answer_)->inlier_ratio, 0.9);
    EXPECT_EQ((*answer_)->position_sigma, 0.01);
    EXPECT_EQ((*answer_)->yaw_sigma, 0.02);
    ASSERT_EQ(server_.locates().size(), 1U);
    EXPECT_EQ(server_.locates()[0].points, points());
    EXPECT_EQ(server_.locates()[0].from, (Point2{0.5, 0.25}));
    EXPECT_EQ(server_.locates()[0].near, kNear);
}

TEST_F(LocationTest, WithAFirstPoseIsSearchedAroundIt) {
    serve({.location = Error{Errc::kNothingMapped, "nothing"},
           .locations = {Error{Errc::kAmbiguous, "here or there"},
                         wire::Correction{{10.0, 20.0, 0.0}, 7, 0.9, 0.01, 0.02},
                         Error{Errc::kAmbiguous, "here or there"}}});
    EXPECT_THAT(asked_four_times(),
                testing::ElementsAre(kNear, kNear, wire::Near{{10.5, 20.25}, 100.0}, wire::Near{{10.5, 20.25}, 100.0}));
}

TEST_F(LocationTest, OnAnEmptyMapIsSearchedAroundTheFirstPlace) {
    serve(
        {.location = Error{Errc::kUndetermined, "too little"}, .locations = {Error{Errc::kNothingMapped, "nothing"}}});
    const wire::Near around{kFirstPlace, 100.0};
    EXPECT_THAT(asked_four_times(), testing::ElementsAre(kNear, around, around, around));
}

TEST_F(LocationTest, IsRequestedAfterEarlierScansAreApplied) {
    serve({});
    ScriptedSource source;
    source.allow(40);
    source.on_given = [&](std::uint64_t given) {
        if (given == 40) asio::co_spawn(uplink_->executor(), ask(*uplink_, source), [](std::exception_ptr) {});
    };
    server_.on_stored = [&](std::size_t) { EXPECT_TRUE(server_.locates().empty()); };
    ASSERT_TRUE(run(source, nullptr));
    EXPECT_TRUE(answer_ && *answer_);
    EXPECT_EQ(server_.locates().size(), 1U);
    expect_stored(40);
}

TEST_F(LocationTest, ReturnsTheServersRefusalUnchanged) {
    const Error refusal{Errc::kAmbiguous, "here or there"};
    serve({.location = refusal});
    ScriptedSource source;
    ASSERT_TRUE(run_and_ask(source));
    ASSERT_TRUE(answer_);
    EXPECT_EQ(answer_->error(), refusal);
}

TEST_F(LocationTest, OnAnOldServerEndsTheLinkWithAHint) {
    serve({.knows_locating = false});
    ScriptedSource source;
    const auto outcome = run_and_ask(source);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("update the server, or give the robot's pose"));
    EXPECT_FALSE(answer_);
}

TEST_F(LocationTest, CancelledRequestsFreeTheirSlots) {
    serve({.hang_up_after_requests = 1});
    ScriptedSource source;
    const auto leave = [&]() -> asio::awaitable<void> {
        const Locate locate = located_by(*uplink_, std::nullopt, kFirstPlace);
        const auto until_asked = [&]() -> asio::awaitable<void> {
            while (server_.locates().empty()) co_await asio::post(asio::use_awaitable);
        };
        co_await (locate(points(), Point2{0.0, 0.0}) || until_asked());
        serve({});
        co_await ask(*uplink_, source);
    };
    ASSERT_TRUE(run(source, nullptr, [&] {
        asio::co_spawn(uplink_->executor(), leave(), [](std::exception_ptr failed) { EXPECT_FALSE(failed); });
    }));
    EXPECT_TRUE(answer_ && *answer_);
    EXPECT_EQ(server_.locates().size(), 2U) << "a cancelled request is not sent again on the next link";
}

TEST_F(LocationTest, OfACarriedLidarIsRequestedAtEachPlaceAndSetInEveryScan) {
    const Pose2 T_map_odom{1.0, 2.0, 0.5};
    serve({.location = wire::Correction{T_map_odom, 7, 0.9, 0.01, 0.02}});
    CarriedLidar lidar;
    auto turns = lidar.turns_at(kHere, 20);
    for (auto& turn : lidar.turns_between(kHere, kThere, 30)) turns.push_back(std::move(turn));
    for (auto& turn : lidar.turns_at(kThere, 20)) turns.push_back(std::move(turn));
    std::vector<std::size_t> stored_when_asked;
    server_.on_stored = [&](std::size_t stored) {
        if (server_.locates().size() > stored_when_asked.size()) stored_when_asked.push_back(stored - 1);
    };
    LocatingSource source(std::make_unique<ReplayedSource>(std::make_unique<RecordedSource>(std::move(turns))), {},
                          options_.on_message);
    const auto outcome =
        run(source, nullptr, [&] { source.ask_with(located_by(*uplink_, std::nullopt, kFirstPlace)); });
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_EQ(server_.faults(), std::vector<std::string>());
    EXPECT_EQ(server_.locates().size(), 2U);
    EXPECT_EQ(stored_when_asked, (std::vector<std::size_t>{0, 17}));
    ASSERT_EQ(server_.stored().size(), 17U + 20U);
    for (const Scan& scan : server_.stored()) EXPECT_EQ(scan.pose, T_map_odom);
    EXPECT_EQ(source.remarks(), "carried 1 time, 33 turns while carried or not localized");
}

} // namespace
} // namespace scanloom::robot
