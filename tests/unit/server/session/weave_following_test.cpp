#include "tests/unit/server/session/weave_fixture.hpp"

#include <thread>

namespace scanloom::session {
namespace {

/// Of a log that grows between the questions.
class FollowingWeaveTest : public WeaveFixture {
protected:
    [[nodiscard]] static std::vector<int> once(Revision entries) { return std::vector<int>(entries, 1); }
};

TEST_F(FollowingWeaveTest, AskedAgainItGoesOnFromWhereItIs) {
    const SessionOptions options{.cell_size = 0.1};
    std::shared_ptr<Weave> first;
    for (const Revision revision : {Revision{0}, Revision{1}, Revision{10}, Revision{10}, Revision{11}, Revision{42}}) {
        append_up_to(revision);
        const auto weave = woven(request(options));
        if (!first) first = weave;
        EXPECT_EQ(weave, first);
        EXPECT_EQ(weave->progress().state, State::kDone);
        EXPECT_EQ(weave->progress().target, revision);
        EXPECT_EQ(weave->progress().woven, revision);
        EXPECT_EQ(weave->progress().revision, revision);
        EXPECT_TRUE(weave->progress().follows);
        EXPECT_EQ(digests_of(*weave->maps()), created_so(options, revision));
        EXPECT_EQ(log_.taken(), once(revision));
    }
    EXPECT_THAT(weaves_.list(session_.id), testing::ElementsAre(first));
}

TEST_F(FollowingWeaveTest, AskedAgainUnderWayItIsJoinedAndEverybodyIsServedInTurn) {
    append_up_to(20);
    const auto first_round = log_.pause_at(10);
    const auto second_round = log_.pause_at(30);
    const auto weave = ask(request({}));
    first_round->wait();
    append_all();
    EXPECT_EQ(ask(request({})), weave);
    EXPECT_EQ(weave->progress().target, 42U);
    first_round->end();
    const auto for_the_first = weave->wait(20, kLong);
    ASSERT_NE(for_the_first, nullptr);
    EXPECT_EQ(digests_of(*for_the_first), created_so({}, 20));
    second_round->wait();
    EXPECT_EQ(weave->progress().state, State::kWeaving);
    EXPECT_EQ(weave->progress().revision, 20U) << "shown meanwhile";
    EXPECT_EQ(weave->progress().woven, 29U);
    EXPECT_EQ(weave->wait(42, std::chrono::milliseconds(0)), nullptr);
    second_round->end();
    const auto for_the_second = weave->wait(42, kLong);
    ASSERT_NE(for_the_second, nullptr);
    EXPECT_EQ(digests_of(*for_the_second), created_so({}, 42));
    EXPECT_EQ(log_.taken(), once(42));
    EXPECT_THAT(weaves_.list(session_.id), testing::SizeIs(1));
}

TEST_F(FollowingWeaveTest, BetweenTwoRoundsOthersHaveTheirTurn) {
    boost::asio::thread_pool one(1);
    Weaves weaves(log_, one.get_executor());
    append_up_to(20);
    const auto first_round = log_.pause_at(10);
    const auto next = log_.pause_at(30);
    const auto weave = weaves.start(session_, request({}), 20).value();
    first_round->wait();
    append_all();
    const auto other = weaves.start(session_, request({.cell_size = 0.1}), 42).value();
    EXPECT_EQ(weaves.start(session_, request({}), 42).value(), weave);
    first_round->end();
    next->wait();
    EXPECT_EQ(weave->progress().state, State::kWaiting);
    EXPECT_EQ(weave->progress().revision, 20U);
    EXPECT_EQ(other->progress().state, State::kWeaving);
    next->end();
    finish(*weave);
    EXPECT_EQ(weave->progress().revision, 42U);
    one.join();
}

TEST_F(FollowingWeaveTest, AsksFromManyThreadsWeaveNoEntryTwice) {
    std::vector<std::thread> viewers;
    std::atomic<Revision> newest = 0;
    for (int n = 0; n < 4; ++n) {
        viewers.emplace_back([&] {
            for (Revision seen = 0; seen < 42;) {
                const Revision now = newest;
                const auto weave = weaves_.start(session_, request({}), now).value();
                const auto maps = weave->wait(now, kLong);
                ASSERT_NE(maps, nullptr);
                ASSERT_GE(maps->revision, std::max(now, seen));
                seen = maps->revision;
            }
        });
    }
    for (Revision revision = 1; revision <= 42; ++revision) {
        append_up_to(revision);
        newest = revision;
    }
    for (auto& viewer : viewers) viewer.join();
    EXPECT_EQ(log_.taken(), once(42));
    EXPECT_EQ(digests_of(*woven(request({}))->maps()), created_so({}, 42));
    EXPECT_THAT(weaves_.list(session_.id), testing::SizeIs(1));
}

TEST_F(FollowingWeaveTest, AStampThatIsPastIsWovenOnce) {
    append_all();
    const auto past = request({}, {std::nullopt, 1017.5});
    const auto weave = woven(past);
    EXPECT_EQ(weave->progress().state, State::kDone);
    EXPECT_FALSE(weave->progress().follows);
    EXPECT_EQ(weave->progress().target, 19U) << "where it turned out to end";
    append(entries_[1]);
    EXPECT_EQ(ask(past), weave);
    EXPECT_EQ(weave->progress().state, State::kDone);
    EXPECT_EQ(digests_of(*weave->wait(43, kLong)), created_so({}, 19));
    EXPECT_EQ(log_.taken(), once(19));
}

TEST_F(FollowingWeaveTest, AStampToComeIsFollowedToTheFirstLaterScan) {
    const auto to_come = request({}, {std::nullopt, 1017.5});
    append_up_to(10);
    const auto weave = woven(to_come);
    EXPECT_TRUE(weave->progress().follows);
    EXPECT_EQ(digests_of(*weave->maps()), created_so({}, 10));
    append_up_to(19);
    EXPECT_EQ(woven(to_come), weave);
    EXPECT_TRUE(weave->progress().follows) << "one more may have been taken before";
    append_all();
    EXPECT_EQ(woven(to_come), weave);
    EXPECT_FALSE(weave->progress().follows);
    EXPECT_EQ(weave->progress().revision, 19U);
    EXPECT_EQ(log_.taken(), once(19));
}

TEST_F(FollowingWeaveTest, WhatCannotGoOnKeepsItsMapsAndIsTriedAgainFromTheStart) {
    append_up_to(20);
    const auto fine = request({.cell_size = 0.01});
    const auto weave = woven(fine);
    append(SensorDescribed{0, far_laser()});
    EXPECT_EQ(woven(fine), weave);
    EXPECT_EQ(weave->progress().state, State::kFailed);
    EXPECT_THAT(weave->progress().error->message, testing::HasSubstr("500 metres"));
    ASSERT_NE(weave->maps(), nullptr);
    EXPECT_EQ(weave->maps()->revision, 20U);
    EXPECT_EQ(weave->wait(21, kLong), nullptr);
    const auto again = woven(fine);
    EXPECT_NE(again, weave);
    EXPECT_EQ(again->id(), weave->id());
    EXPECT_EQ(log_.taken(), std::vector<int>(20, 2));
    EXPECT_THAT(weaves_.list(session_.id), testing::ElementsAre(again));
}

TEST_F(FollowingWeaveTest, CancelledWhileItGoesOnItEnds) {
    append_up_to(20);
    const auto weave = woven(request({}));
    append_all();
    const auto pause = log_.pause_at(30);
    EXPECT_EQ(ask(request({})), weave);
    pause->wait();
    EXPECT_TRUE(weaves_.remove(session_.id, weave->id()));
    pause->end();
    EXPECT_EQ(weave->wait(42, kLong), nullptr);
    EXPECT_EQ(weave->progress().state, State::kCancelled);
    EXPECT_NE(woven(request({})), weave);
}

/// Rounds of one weave, and the chunks that are left to others.
class FollowingBudgetTest : public FollowingWeaveTest {
protected:
    /// A weave of 20 entries, and 22 more to come.
    Weave& first_round(PageBudget& budget) {
        append_up_to(20);
        EXPECT_FALSE(weave_.run(log_, budget));
        append_all();
        return weave_;
    }

    [[nodiscard]] std::int64_t chunks_of(std::size_t entries) const {
        mapping::Projection projection(weave_.request().config);
        for (std::size_t n = 0; n < entries; ++n) EXPECT_TRUE(projection.fold(entries_[n]));
        return static_cast<std::int64_t>(projection.chunk_count());
    }

    Weave weave_{session_, request({}), 20};
};

TEST_F(FollowingBudgetTest, ItTakesWhatItHasAndWhatItCopiesAndGivesAllOfItBack) {
    constexpr std::int64_t kAll = 1000;
    PageBudget budget(kAll);
    Weave& weave = first_round(budget);
    EXPECT_TRUE(budget.take(kAll)) << "nothing is under way";
    budget.give_back(kAll);
    ASSERT_TRUE(weave.resume(42, budget));
    EXPECT_FALSE(budget.take(kAll - chunks_of(20) + 1));

    const auto pause = log_.pause_at(42);
    std::thread weaving([&] { EXPECT_FALSE(weave.run(log_, budget)); });
    pause->wait();
    EXPECT_NE(weave.maps(), nullptr);
    EXPECT_FALSE(budget.take(kAll - chunks_of(41))) << "copies count";
    EXPECT_TRUE(budget.take(kAll - chunks_of(41) - chunks_of(20))) << "of what there was, at most";
    budget.give_back(kAll - chunks_of(41) - chunks_of(20));
    pause->end();
    weaving.join();
    EXPECT_EQ(digests_of(*weave.maps()), created_so({}, 42));
    EXPECT_TRUE(budget.take(kAll));
}

TEST_F(FollowingBudgetTest, WithoutRoomForCopiesTheEarlierMapsAreShownNoLonger) {
    const auto all = chunks_of(42);
    PageBudget budget(static_cast<std::size_t>(all));
    Weave& weave = first_round(budget);
    ASSERT_TRUE(weave.resume(42, budget));
    const auto pause = log_.pause_at(42);
    std::thread weaving([&] { EXPECT_FALSE(weave.run(log_, budget)); });
    pause->wait();
    EXPECT_EQ(weave.maps(), nullptr);
    pause->end();
    weaving.join();
    EXPECT_EQ(weave.progress().state, State::kDone);
    EXPECT_EQ(digests_of(*weave.maps()), created_so({}, 42));
    EXPECT_TRUE(budget.take(all));
}

TEST_F(FollowingBudgetTest, WithoutRoomForItselfItFailsAndGivesAllBack) {
    const auto all = chunks_of(42) - 1;
    PageBudget budget(static_cast<std::size_t>(all));
    Weave& weave = first_round(budget);
    ASSERT_TRUE(weave.resume(42, budget));
    EXPECT_FALSE(weave.run(log_, budget));
    EXPECT_EQ(weave.progress().error->code, Errc::kFull);
    EXPECT_TRUE(budget.take(all));
}

TEST_F(FollowingBudgetTest, WhenOthersHaveAllRoomItWaitsAndKeepsItsMaps) {
    PageBudget budget(1000);
    Weave& weave = first_round(budget);
    ASSERT_TRUE(budget.take(1000));
    EXPECT_FALSE(weave.resume(42, budget));
    EXPECT_EQ(weave.progress().state, State::kDone);
    EXPECT_EQ(weave.maps()->revision, 20U);
    budget.give_back(1000);
    ASSERT_TRUE(weave.resume(42, budget));
    EXPECT_FALSE(weave.run(log_, budget));
    EXPECT_EQ(weave.maps()->revision, 42U);
}

TEST_F(FollowingWeaveTest, WhoAsksWhileOthersHaveAllRoomIsToldToTryAgain) {
    append_up_to(20);
    const auto chunks = woven(request({}))->maps()->chunk_count;
    Weaves tight(log_, pool_.get_executor(), {.chunks_max = chunks});
    const auto start = [&](double radius) {
        return tight.start(session_, request({.danger_radius = radius}), appended_);
    };
    const auto done = start(0.1).value();
    finish(*done);
    const auto pause = log_.pause_at(20);
    const auto other = start(0.2).value();
    pause->wait();
    append_up_to(21);
    const auto refused = start(0.1);
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    EXPECT_EQ(tight.find(session_.id, done->id())->maps()->revision, 20U);
    pause->end();
    finish(*other);
    EXPECT_EQ(start(0.1).value(), done);
    pool_.join();
}

} // namespace
} // namespace scanloom::session
