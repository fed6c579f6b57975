#include "tests/support/replay_waiting.hpp"
#include "tests/unit/server/sessions/replay_fixture.hpp"

#include <boost/asio/post.hpp>

#include <thread>

namespace scanloom::sessions {
namespace {

const Error kEnough{Errc::kNotFound, "enough"};

/// Replay jobs of a log that does not grow.
class ReplayJobTest : public ReplayFixture {
protected:
    ReplayJobTest() { append_all(); }

    [[nodiscard]] Revision newest() const { return appended_; }
};

TEST_F(ReplayJobTest, EqualsTheMapsOfASessionWithTheseSettings) {
    for (const SessionOptions& options :
         {SessionOptions{}, SessionOptions{.cell_size = 0.1}, SessionOptions{.ray_model = RayModel::kTraversal},
          SessionOptions{.cell_size = 0.02, .p_occupied = 0.7, .class_source = ClassSource::kHimm},
          SessionOptions{.ray_model = RayModel::kBresenham, .accumulate = true, .hit_radius = 0.1}}) {
        const auto job = finished(request(options));
        ASSERT_EQ(job->progress().state, State::kDone);
        EXPECT_EQ(job->progress().applied, newest());
        EXPECT_EQ(digests_of(*job->maps()), digests_of_session(options, newest()));
    }
}

TEST_F(ReplayJobTest, EndsAtARevisionOrBeforeTheFirstLaterScan) {
    for (const Revision revision : {Revision{0}, Revision{1}, Revision{2}, Revision{3}, Revision{17}, newest()}) {
        const auto job = finished(request({}, {revision, std::nullopt}));
        EXPECT_EQ(job->maps()->revision, revision);
        EXPECT_EQ(digests_of(*job->maps()), digests_of_session({}, revision));
    }
    for (const double seconds : {0.5, 1.0, 7.0, 7.5, 39.9, 40.0, 100.0}) {
        const auto entries = 2 + std::min<std::size_t>(kScans, static_cast<std::size_t>(seconds));
        const auto job = finished(request({}, {std::nullopt, 1000.0 + seconds}));
        EXPECT_EQ(digests_of(*job->maps()), digests_of_session({}, entries)) << seconds;
    }
}

TEST_F(ReplayJobTest, EqualRequestReturnsTheSameJob) {
    const auto first = finished(request({}, {5, std::nullopt}));
    EXPECT_EQ(start(request({}, {5, std::nullopt})), first);
    EXPECT_EQ(replay_jobs_.find(session_.id, first->id()), first);
    EXPECT_EQ(replay_jobs_.find(session_.id + 1, first->id()), nullptr);
    for (const auto& other : {request({}), request({}, {6, std::nullopt}), request({}, {std::nullopt, 5.0}),
                              request({.danger_radius = 0.1}, {5, std::nullopt})}) {
        EXPECT_NE(start(other)->id(), first->id());
    }
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::SizeIs(5));
    EXPECT_THAT(replay_jobs_.list(session_.id + 1), testing::IsEmpty());
}

TEST_F(ReplayJobTest, RemovedJobCanBeStartedAgain) {
    const auto first = finished(request({}, {5, std::nullopt}));
    EXPECT_TRUE(replay_jobs_.remove(session_.id, first->id()));
    EXPECT_FALSE(replay_jobs_.remove(session_.id, first->id()));
    EXPECT_EQ(replay_jobs_.find(session_.id, first->id()), nullptr);
    EXPECT_NE(finished(request({}, {5, std::nullopt})), first);
    replay_jobs_.remove_all(session_.id);
    EXPECT_THAT(replay_jobs_.list(session_.id), testing::IsEmpty());
}

TEST_F(ReplayJobTest, SensorTooLargeForTheSettingsFailsWithAMessage) {
    append(SensorDescribed{0, far_laser()});
    const auto job = finished(request({.cell_size = 0.01}));
    EXPECT_EQ(job->progress().state, State::kFailed);
    EXPECT_EQ(job->progress().error->message,
              "sensor 2 ('far') of robot 'r' reaches 500 metres, more than 8192 cells of 0.01 metres; give a cell_size "
              "of 0.062 or more");
    EXPECT_EQ(job->maps(), nullptr);
    EXPECT_EQ(finished(request({.cell_size = 0.062}))->progress().state, State::kDone);
}

TEST_F(ReplayJobTest, ScanTooLargeForTheSettingsFails) {
    Sensor ring = testing_support::small_laser();
    ring.id = 9;
    ring.name = "";
    ring.kind = SensorKind::kSonar;
    ring.angles = UniformAngles{0.0, 0.001, 4096};
    ring.aperture = 3.0;
    ring.range_max = 68.0;
    Scan scan = testing_support::random_scan(1, kScans + 1);
    scan.sensor = 9;
    scan.ranges.assign(4096, kNoReturn);
    append(SensorDescribed{0, ring});
    append(ScanTaken{0, scan});
    const auto job = finished(request({.cell_size = 0.01}));
    EXPECT_EQ(job->progress().state, State::kFailed);
    EXPECT_EQ(
        job->progress().error->message,
        "scan 41 by sensor 9 of robot 'r' covers too many cells of 0.01 metres to be computed at once; give a larger "
        "cell_size");
}

TEST_F(ReplayJobTest, ImportedMapOfTooManyCellsFails) {
    MapPatch patch;
    patch.cell_size = 1.0;
    patch.width = 512;
    patch.cells.assign(std::size_t{512} * 512, MapCell::kFree);
    WatchedLog log;
    SessionInfo session;
    session.id = log.create_session("s").value();
    log.append(session.id, 1, {wire::encode_entry(patch)}, [](const Result<>&) {});
    limits::MemoryBudget budget(1'000'000);
    ReplayJob job(session, request({.cell_size = 0.01}), 1);
    EXPECT_FALSE(job.run(log, budget));
    EXPECT_EQ(job.progress().error->message,
              "a part of the imported map covers too many cells of 0.01 metres to be computed at once; give a larger "
              "cell_size");
}

TEST_F(ReplayJobTest, DeletedSessionFailsTheJobWithAMessage) {
    ASSERT_TRUE(log_.remove_session(session_.id));
    const auto job = finished(request({}));
    EXPECT_EQ(job->progress().state, State::kFailed);
    EXPECT_EQ(*job->progress().error, session_was_deleted(session_));
    EXPECT_EQ(session_was_deleted(session_).code, Errc::kNotFound);
    EXPECT_THAT(session_was_deleted(session_).message, testing::StartsWith("session 's' was deleted"));
}

TEST_F(ReplayJobTest, LongJobRunsInTurns) {
    limits::MemoryBudget budget(1000);
    ReplayJob job(session_, request({}), newest());
    int turns = 1;
    while (job.run(log_, budget, 5e4)) { // a few entries per turn
        EXPECT_EQ(job.progress().state, State::kWaiting);
        EXPECT_EQ(job.maps(), nullptr);
        EXPECT_LT(job.progress().applied, newest());
        ++turns;
    }
    EXPECT_GT(turns, 3);
    EXPECT_EQ(job.progress().state, State::kDone);
    EXPECT_EQ(digests_of(*job.maps()), digests_of_session({}, newest()));
    EXPECT_EQ(log_.taken(), std::vector<int>(newest(), 1));
}

TEST_F(ReplayJobTest, CancelBetweenTwoTurnsReturnsTheChunks) {
    limits::MemoryBudget budget(1000);
    ReplayJob job(session_, request({}), newest());
    ASSERT_TRUE(job.run(log_, budget, 5e4));
    job.cancel(kEnough);
    EXPECT_FALSE(job.run(log_, budget, 5e4));
    EXPECT_EQ(job.progress().state, State::kCancelled);
    EXPECT_TRUE(budget.take(1000));
}

TEST_F(ReplayJobTest, JobCancelledBeforeItsTurnNeverRuns) {
    limits::MemoryBudget budget(1000);
    ReplayJob job(session_, request({}), newest());
    job.cancel(kEnough);
    EXPECT_EQ(testing_support::wait_for_maps(job, newest(), std::chrono::milliseconds(0)), nullptr);
    EXPECT_FALSE(job.run(log_, budget));
    EXPECT_EQ(job.progress().state, State::kCancelled);
    EXPECT_EQ(job.progress().error, kEnough);
    EXPECT_EQ(job.progress().applied, 0U);
    EXPECT_EQ(job.maps(), nullptr);
}

TEST_F(ReplayJobTest, CancelDuringATurnReturnsTheChunks) {
    const auto pause = log_.pause_at(10);
    limits::MemoryBudget budget(1000);
    ReplayJob job(session_, request({}), newest());
    std::thread runner([&] { EXPECT_FALSE(job.run(log_, budget)); });
    pause->wait();
    EXPECT_EQ(job.progress().state, State::kRunning);
    EXPECT_EQ(job.progress().applied, 9U);
    EXPECT_EQ(testing_support::wait_for_maps(job, newest(), std::chrono::milliseconds(0)), nullptr);
    job.cancel(kEnough);
    job.cancel({Errc::kInternal, "again"});
    pause->end();
    runner.join();
    EXPECT_EQ(job.progress().state, State::kCancelled);
    EXPECT_EQ(job.progress().error, kEnough) << "the first reason is kept";
    EXPECT_EQ(job.progress().applied, 9U);
    EXPECT_TRUE(budget.take(1000)) << "all chunks are returned";
}

TEST_F(ReplayJobTest, EachEndReportsItsReason) {
    boost::asio::thread_pool idle(1);
    std::promise<void> go_on;
    boost::asio::post(idle, [&] { go_on.get_future().wait(); });
    ReplayJobs some(log_, idle.get_executor());
    const auto removed = some.start(session_, request({}, {1, std::nullopt}), newest()).value();
    some.remove(session_.id, removed->id());
    EXPECT_EQ(removed->progress().error->code, Errc::kNotFound);
    EXPECT_THAT(removed->progress().error->message, testing::HasSubstr("replay job " + removed->id() + " was deleted"));
    const auto deleted = some.start(session_, request({}, {2, std::nullopt}), newest()).value();
    some.remove_all(session_.id);
    EXPECT_EQ(deleted->progress().error, session_was_deleted(session_));
    const auto stopped = some.start(session_, request({}, {3, std::nullopt}), newest()).value();
    some.stop();
    EXPECT_EQ(stopped->progress().error->code, Errc::kShuttingDown);
    go_on.set_value();
    idle.join();
}

TEST_F(ReplayJobTest, FailsBeyondTheBudgetAndTakesNoChunks) {
    limits::MemoryBudget budget(3);
    ReplayJob job(session_, request({.cell_size = 0.01}), newest());
    EXPECT_FALSE(job.run(log_, budget));
    EXPECT_EQ(job.progress().state, State::kFailed);
    EXPECT_EQ(job.progress().error->code, Errc::kFull);
    EXPECT_TRUE(budget.take(3));
}

TEST_F(ReplayJobTest, CountsTheChunksOfAllJobs) {
    EXPECT_EQ(replay_jobs_.chunks(), 0);
    const auto job = finished(request({}));
    const auto chunks = static_cast<std::int64_t>(job->maps()->chunk_count);
    EXPECT_EQ(replay_jobs_.chunks(), chunks);
    static_cast<void>(finished(request({.danger_radius = 0.2})));
    EXPECT_EQ(replay_jobs_.chunks(), 2 * chunks);
    EXPECT_TRUE(replay_jobs_.remove(session_.id, job->id()));
    EXPECT_EQ(replay_jobs_.chunks(), chunks);
}

TEST_F(ReplayJobTest, RemovesTheLeastRecentlyUsedBeyondTheChunkLimit) {
    const auto chunks = finished(request({}))->maps()->chunk_count;
    ReplayJobs few(log_, pool_.get_executor(), {.chunks_kept_max = 3 * chunks});
    std::vector<std::string> ids;
    for (const double radius : {0.1, 0.2, 0.3}) {
        const auto job = few.start(session_, request({.danger_radius = radius}), newest()).value();
        finish(*job);
        ids.push_back(job->id());
    }
    EXPECT_NE(few.find(session_.id, ids[0]), nullptr) << "the lookup marks the job as used";
    const auto fourth = few.start(session_, request({.danger_radius = 0.4}), newest()).value();
    finish(*fourth);
    EXPECT_NE(few.find(session_.id, fourth->id()), nullptr);
    EXPECT_NE(few.find(session_.id, ids[0]), nullptr);
    EXPECT_EQ(few.find(session_.id, ids[1]), nullptr);
    pool_.join();
}

TEST_F(ReplayJobTest, RefusesTooManyWaitingJobsAndJobsAfterStop) {
    boost::asio::thread_pool idle(1);
    std::promise<void> go_on;
    boost::asio::post(idle, [&] { go_on.get_future().wait(); });
    ReplayJobs few(log_, idle.get_executor(), {.waiting_max = 2});
    EXPECT_TRUE(few.start(session_, request({}, {1, std::nullopt}), newest()));
    EXPECT_TRUE(few.start(session_, request({}, {2, std::nullopt}), newest()));
    EXPECT_EQ(few.start(session_, request({}, {3, std::nullopt}), newest()).error().code, Errc::kOverloaded);
    EXPECT_TRUE(few.start(session_, request({}, {1, std::nullopt}), newest())) << "the job exists already";
    few.stop();
    EXPECT_EQ(few.start(session_, request({}, {4, std::nullopt}), newest()).error().code, Errc::kShuttingDown);
    for (const auto& job : few.list(session_.id)) EXPECT_EQ(job->progress().state, State::kCancelled);
    go_on.set_value();
    idle.join();
}

} // namespace
} // namespace scanloom::sessions
