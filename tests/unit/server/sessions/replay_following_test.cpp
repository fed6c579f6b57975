#include "tests/support/replay_waiting.hpp"
#include "tests/unit/server/sessions/replay_fixture.hpp"

#include <thread>

namespace scanloom::sessions {
namespace {

/// Replay jobs of a log that grows between requests.
class FollowingReplayTest : public ReplayFixture {
protected:
    [[nodiscard]] static std::vector<int> once(Revision entries) { return std::vector<int>(entries, 1); }
};

TEST_F(FollowingReplayTest, RepeatedRequestContinuesTheJob) {
    const SessionOptions options{.cell_size = 0.1};
    std::shared_ptr<ReplayJob> first;
    for (const Revision revision : {Revision{0}, Revision{1}, Revision{10}, Revision{10}, Revision{11}, Revision{42}}) {
        append_up_to(revision);
        const auto job = finished(request(options));
        if (!first) first = job;
        EXPECT_EQ(job, first);
        EXPECT_EQ(job->progress().state, State::kDone);
        EXPECT_EQ(job->progress().target, revision);
        EXPECT_EQ(job->progress().applied, revision);
        EXPECT_EQ(job->progress().revision, revision);
        EXPECT_TRUE(job->progress().follows);
        EXPECT_EQ(digests_of(*job->maps()), digests_of_session(options, revision));
        EXPECT_EQ(log_.taken(), once(revision));
    }
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::ElementsAre(first));
}

TEST_F(FollowingReplayTest, RequestsJoinARunningJobAndAreServedInOrder) {
    append_up_to(20);
    const auto first_round = log_.pause_at(10);
    const auto second_round = log_.pause_at(30);
    const auto job = start(request({}));
    first_round->wait();
    append_all();
    EXPECT_EQ(start(request({})), job);
    EXPECT_EQ(job->progress().target, 42U);
    first_round->end();
    const auto for_the_first = testing_support::wait_for_maps(*job, 20, kTimeout);
    ASSERT_NE(for_the_first, nullptr);
    EXPECT_EQ(digests_of(*for_the_first), digests_of_session({}, 20));
    second_round->wait();
    EXPECT_EQ(job->progress().state, State::kRunning);
    EXPECT_EQ(job->progress().revision, 20U) << "the earlier maps stay available";
    EXPECT_EQ(job->progress().applied, 29U);
    EXPECT_EQ(testing_support::wait_for_maps(*job, 42, std::chrono::milliseconds(0)), nullptr);
    second_round->end();
    const auto for_the_second = testing_support::wait_for_maps(*job, 42, kTimeout);
    ASSERT_NE(for_the_second, nullptr);
    EXPECT_EQ(digests_of(*for_the_second), digests_of_session({}, 42));
    EXPECT_EQ(log_.taken(), once(42));
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::SizeIs(1));
}

TEST_F(FollowingReplayTest, OtherJobsRunBetweenTwoRounds) {
    boost::asio::thread_pool one(1);
    ReplayJobs replay_jobs(log_, one.get_executor());
    append_up_to(20);
    const auto first_round = log_.pause_at(10);
    const auto next = log_.pause_at(30);
    const auto job = replay_jobs.start(session_, request({}), 20).value();
    first_round->wait();
    append_all();
    const auto other = replay_jobs.start(session_, request({.cell_size = 0.1}), 42).value();
    EXPECT_EQ(replay_jobs.start(session_, request({}), 42).value(), job);
    first_round->end();
    next->wait();
    EXPECT_EQ(job->progress().state, State::kWaiting);
    EXPECT_EQ(job->progress().revision, 20U);
    EXPECT_EQ(other->progress().state, State::kRunning);
    next->end();
    finish(*job);
    EXPECT_EQ(job->progress().revision, 42U);
    one.join();
}

TEST_F(FollowingReplayTest, ConcurrentRequestsReadEachEntryOnce) {
    std::vector<std::thread> viewers;
    std::atomic<Revision> newest = 0;
    for (int n = 0; n < 4; ++n) {
        viewers.emplace_back([&] {
            for (Revision seen = 0; seen < 42;) {
                const Revision now = newest;
                const auto job = replay_jobs_.start(session_, request({}), now).value();
                const auto maps = testing_support::wait_for_maps(*job, now, kTimeout);
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
    EXPECT_EQ(digests_of(*finished(request({}))->maps()), digests_of_session({}, 42));
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::SizeIs(1));
}

TEST_F(FollowingReplayTest, PastStampIsReplayedOnce) {
    append_all();
    const auto past = request({}, {std::nullopt, 1017.5});
    const auto job = finished(past);
    EXPECT_EQ(job->progress().state, State::kDone);
    EXPECT_FALSE(job->progress().follows);
    EXPECT_EQ(job->progress().target, 19U) << "the target is the entry at which the job ended";
    append(entries_[1]);
    EXPECT_EQ(start(past), job);
    EXPECT_EQ(job->progress().state, State::kDone);
    EXPECT_EQ(digests_of(*testing_support::wait_for_maps(*job, 43, kTimeout)), digests_of_session({}, 19));
    EXPECT_EQ(log_.taken(), once(19));
}

TEST_F(FollowingReplayTest, FutureStampIsFollowedToTheFirstLaterScan) {
    const auto to_come = request({}, {std::nullopt, 1017.5});
    append_up_to(10);
    const auto job = finished(to_come);
    EXPECT_TRUE(job->progress().follows);
    EXPECT_EQ(digests_of(*job->maps()), digests_of_session({}, 10));
    append_up_to(19);
    EXPECT_EQ(finished(to_come), job);
    EXPECT_TRUE(job->progress().follows) << "the next scan may have an earlier stamp";
    append_all();
    EXPECT_EQ(finished(to_come), job);
    EXPECT_FALSE(job->progress().follows);
    EXPECT_EQ(job->progress().revision, 19U);
    EXPECT_EQ(log_.taken(), once(19));
}

TEST_F(FollowingReplayTest, FailedContinuationKeepsItsMapsAndRestarts) {
    append_up_to(20);
    const auto fine = request({.cell_size = 0.01});
    const auto job = finished(fine);
    append(SensorDescribed{0, far_laser()});
    EXPECT_EQ(finished(fine), job);
    EXPECT_EQ(job->progress().state, State::kFailed);
    EXPECT_THAT(job->progress().error->message, testing::HasSubstr("500 metres"));
    ASSERT_NE(job->maps(), nullptr);
    EXPECT_EQ(job->maps()->revision, 20U);
    EXPECT_EQ(testing_support::wait_for_maps(*job, 21, kTimeout), nullptr);
    const auto again = finished(fine);
    EXPECT_NE(again, job);
    EXPECT_EQ(again->id(), job->id());
    EXPECT_EQ(log_.taken(), std::vector<int>(20, 2));
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::ElementsAre(again));
}

TEST_F(FollowingReplayTest, CancelledContinuationEnds) {
    append_up_to(20);
    const auto job = finished(request({}));
    append_all();
    const auto pause = log_.pause_at(30);
    EXPECT_EQ(start(request({})), job);
    pause->wait();
    EXPECT_TRUE(replay_jobs_.remove(session_.id, job->id()));
    pause->end();
    EXPECT_EQ(testing_support::wait_for_maps(*job, 42, kTimeout), nullptr);
    EXPECT_EQ(job->progress().state, State::kCancelled);
    EXPECT_NE(finished(request({})), job);
}

/// Rounds of one replay job, and the chunks that remain for others.
class FollowingBudgetTest : public FollowingReplayTest {
protected:
    /// Runs a job of 20 entries and appends 22 more.
    ReplayJob& first_round(limits::MemoryBudget& budget) {
        append_up_to(20);
        EXPECT_FALSE(job_.run(log_, budget));
        append_all();
        return job_;
    }

    [[nodiscard]] std::int64_t chunks_of(std::size_t entries) const {
        mapping::Projection projection(job_.request().config);
        for (std::size_t n = 0; n < entries; ++n) EXPECT_TRUE(projection.apply(entries_[n]));
        return static_cast<std::int64_t>(projection.chunk_count());
    }

    ReplayJob job_{session_, request({}), 20};
};

TEST_F(FollowingBudgetTest, TakesItsChunksAndCopiesAndReturnsThem) {
    constexpr std::int64_t kAll = 1000;
    limits::MemoryBudget budget(kAll);
    ReplayJob& job = first_round(budget);
    EXPECT_TRUE(budget.take(kAll)) << "no chunks are taken between rounds";
    budget.give_back(kAll);
    ASSERT_TRUE(job.resume(42, budget));
    EXPECT_FALSE(budget.take(kAll - chunks_of(20) + 1));

    const auto pause = log_.pause_at(42);
    std::thread runner([&] { EXPECT_FALSE(job.run(log_, budget)); });
    pause->wait();
    EXPECT_NE(job.maps(), nullptr);
    EXPECT_FALSE(budget.take(kAll - chunks_of(41))) << "copied chunks count";
    EXPECT_TRUE(budget.take(kAll - chunks_of(41) - chunks_of(20)))
        << "copies need at most as many chunks as the earlier maps";
    budget.give_back(kAll - chunks_of(41) - chunks_of(20));
    pause->end();
    runner.join();
    EXPECT_EQ(digests_of(*job.maps()), digests_of_session({}, 42));
    EXPECT_TRUE(budget.take(kAll));
}

TEST_F(FollowingBudgetTest, DropsTheEarlierMapsWithoutRoomForCopies) {
    const auto all = chunks_of(42);
    limits::MemoryBudget budget(static_cast<std::size_t>(all));
    ReplayJob& job = first_round(budget);
    ASSERT_TRUE(job.resume(42, budget));
    const auto pause = log_.pause_at(42);
    std::thread runner([&] { EXPECT_FALSE(job.run(log_, budget)); });
    pause->wait();
    EXPECT_EQ(job.maps(), nullptr);
    pause->end();
    runner.join();
    EXPECT_EQ(job.progress().state, State::kDone);
    EXPECT_EQ(digests_of(*job.maps()), digests_of_session({}, 42));
    EXPECT_TRUE(budget.take(all));
}

TEST_F(FollowingBudgetTest, FailsAndReturnsAllChunksWithoutRoom) {
    const auto all = chunks_of(42) - 1;
    limits::MemoryBudget budget(static_cast<std::size_t>(all));
    ReplayJob& job = first_round(budget);
    ASSERT_TRUE(job.resume(42, budget));
    EXPECT_FALSE(job.run(log_, budget));
    EXPECT_EQ(job.progress().error->code, Errc::kFull);
    EXPECT_TRUE(budget.take(all));
}

TEST_F(FollowingBudgetTest, WaitsAndKeepsItsMapsWhileOthersHaveAllRoom) {
    limits::MemoryBudget budget(1000);
    ReplayJob& job = first_round(budget);
    ASSERT_TRUE(budget.take(1000));
    EXPECT_FALSE(job.resume(42, budget));
    EXPECT_EQ(job.progress().state, State::kDone);
    EXPECT_EQ(job.maps()->revision, 20U);
    budget.give_back(1000);
    ASSERT_TRUE(job.resume(42, budget));
    EXPECT_FALSE(job.run(log_, budget));
    EXPECT_EQ(job.maps()->revision, 42U);
}

TEST_F(FollowingReplayTest, RequestIsOverloadedWhileOthersHaveAllRoom) {
    append_up_to(20);
    const auto chunks = finished(request({}))->maps()->chunk_count;
    ReplayJobs tight(log_, pool_.get_executor(), {.chunks_max = chunks});
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
} // namespace scanloom::sessions
