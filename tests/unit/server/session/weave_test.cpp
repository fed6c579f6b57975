#include "server/session/weave.hpp"

#include "common/wire/log_codec.hpp"
#include "server/session/weaves.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

namespace scanloom::session {
namespace {

using State = Weave::State;
using testing_support::digests_of;

constexpr std::chrono::minutes kLong{2}; // for what is sure to come

/// A log of 40 scans, taken a second apart.
class WeaveTest : public testing::Test {
protected:
    static constexpr std::uint64_t kScans = 40;

    WeaveTest() {
        entries_ = {RobotJoined{0, "r"}, SensorDescribed{0, testing_support::small_laser()}};
        for (std::uint64_t seq = 1; seq <= kScans; ++seq) {
            Scan scan = testing_support::random_scan(static_cast<unsigned>(seq), seq);
            scan.stamp = 1000.0 + static_cast<double>(seq);
            entries_.push_back(ScanTaken{0, std::move(scan)});
        }
        session_.id = log_.create_session("s").value();
        session_.name = "s";
        std::vector<std::string> bytes;
        for (const auto& entry : entries_) bytes.push_back(wire::encode_entry(entry));
        std::promise<Result<>> appended;
        log_.append(session_.id, 1, std::move(bytes), [&](Result<> done) { appended.set_value(std::move(done)); });
        EXPECT_TRUE(appended.get_future().get());
    }
    ~WeaveTest() override {
        weaves_.stop();
        pool_.join();
    }

    [[nodiscard]] Revision newest() const { return entries_.size(); }

    [[nodiscard]] static WeaveRequest request(const SessionOptions& options, WeaveEnd end) {
        return {mapping::resolve(options).value(), end};
    }

    /// What a session shows that was created with these options and given so many entries of this log.
    [[nodiscard]] std::string created_so(const SessionOptions& options, std::size_t entries) const {
        mapping::Projection projection(mapping::resolve(options).value());
        for (std::size_t n = 0; n < entries; ++n) EXPECT_TRUE(projection.fold(entries_[n]));
        return digests_of(projection.snapshot());
    }

    [[nodiscard]] std::shared_ptr<Weave> woven(const WeaveRequest& wanted) {
        auto weave = weaves_.start(session_, wanted).value();
        EXPECT_TRUE(weave->wait(kLong));
        return weave;
    }

    store::MemoryScanLog log_;
    SessionInfo session_;
    std::vector<LogEntry> entries_;
    boost::asio::thread_pool pool_{2};
    Weaves weaves_{log_, pool_.get_executor()};
};

TEST_F(WeaveTest, IsWhatASessionCreatedWithTheseSettingsWouldShow) {
    for (const SessionOptions& options :
         {SessionOptions{}, SessionOptions{.cell_size = 0.1}, SessionOptions{.ray_model = RayModel::kTraversal},
          SessionOptions{.cell_size = 0.02, .p_occupied = 0.7, .class_source = ClassSource::kHimm},
          SessionOptions{.ray_model = RayModel::kBresenham, .accumulate = true, .hit_radius = 0.1}}) {
        const auto weave = woven(request(options, {newest(), std::nullopt}));
        ASSERT_EQ(weave->progress().state, State::kDone);
        EXPECT_EQ(weave->progress().woven, newest());
        EXPECT_EQ(digests_of(*weave->maps()), created_so(options, newest()));
    }
}

TEST_F(WeaveTest, EndsWithARevisionOrBeforeTheFirstScanTakenLater) {
    for (const Revision revision : {Revision{0}, Revision{1}, Revision{2}, Revision{3}, Revision{17}, newest()}) {
        const auto weave = woven(request({}, {revision, std::nullopt}));
        EXPECT_EQ(weave->maps()->revision, revision);
        EXPECT_EQ(digests_of(*weave->maps()), created_so({}, revision));
    }
    for (const double seconds : {0.5, 1.0, 7.0, 7.5, 39.9, 40.0, 100.0}) {
        const auto entries = 2 + std::min<std::size_t>(kScans, static_cast<std::size_t>(seconds));
        const auto weave = woven(request({}, {newest(), 1000.0 + seconds}));
        EXPECT_EQ(digests_of(*weave->maps()), created_so({}, entries)) << seconds;
    }
}

TEST_F(WeaveTest, IsFoundAgainAndToldFromOthers) {
    const auto first = woven(request({}, {5, std::nullopt}));
    EXPECT_EQ(weaves_.start(session_, request({}, {5, std::nullopt})).value(), first);
    EXPECT_EQ(weaves_.find(session_.id, first->id()), first);
    EXPECT_EQ(weaves_.find(session_.id + 1, first->id()), nullptr);
    for (const auto& other : {request({}, {6, std::nullopt}), request({}, {5, 1000.0}),
                              request({.danger_radius = 0.1}, {5, std::nullopt})}) {
        EXPECT_NE(weaves_.start(session_, other).value()->id(), first->id());
    }
    EXPECT_THAT(weaves_.list(session_.id), testing::SizeIs(4));
    EXPECT_THAT(weaves_.list(session_.id + 1), testing::IsEmpty());
}

TEST_F(WeaveTest, OneThatIsRemovedIsGoneAndCanBeStartedAgain) {
    const auto first = woven(request({}, {5, std::nullopt}));
    EXPECT_TRUE(weaves_.remove(session_.id, first->id()));
    EXPECT_FALSE(weaves_.remove(session_.id, first->id()));
    EXPECT_EQ(weaves_.find(session_.id, first->id()), nullptr);
    EXPECT_NE(woven(request({}, {5, std::nullopt})), first);
    weaves_.remove_all(session_.id);
    EXPECT_THAT(weaves_.list(session_.id), testing::IsEmpty());
}

TEST_F(WeaveTest, WhatTheSettingsCannotTakeFailsWithTheReason) {
    entries_.clear();
    Sensor far = testing_support::small_laser();
    far.range_max = 500.0;
    std::promise<void> appended;
    log_.append(session_.id, kScans + 3, {wire::encode_entry(SensorDescribed{0, far})},
                [&](const Result<>&) { appended.set_value(); });
    appended.get_future().wait();
    const auto weave = woven(request({.cell_size = 0.01}, {kScans + 3, std::nullopt}));
    EXPECT_EQ(weave->progress().state, State::kFailed);
    EXPECT_THAT(weave->progress().error->message, testing::StartsWith("range_max is 500"));
    EXPECT_EQ(weave->maps(), nullptr);
    EXPECT_EQ(woven(request({.cell_size = 0.1}, {kScans + 3, std::nullopt}))->progress().state, State::kDone);
}

TEST_F(WeaveTest, AScanThatNoSessionOfTheseSettingsWouldTakeFails) {
    Sensor ring = testing_support::small_laser();
    ring.id = 9;
    ring.kind = SensorKind::kSonar;
    ring.angles = UniformAngles{0.0, 0.001, 4096};
    ring.aperture = 3.0;
    ring.range_max = 68.0;
    Scan scan = testing_support::random_scan(1, kScans + 1);
    scan.sensor = 9;
    scan.ranges.assign(4096, kNoReturn);
    std::promise<void> appended;
    log_.append(session_.id, kScans + 3,
                {wire::encode_entry(SensorDescribed{0, ring}), wire::encode_entry(ScanTaken{0, scan})},
                [&](const Result<>&) { appended.set_value(); });
    appended.get_future().wait();
    const auto weave = woven(request({.cell_size = 0.01}, {kScans + 4, std::nullopt}));
    EXPECT_EQ(weave->progress().state, State::kFailed);
    EXPECT_THAT(weave->progress().error->message, testing::HasSubstr("too many cells"));
}

TEST_F(WeaveTest, OneCancelledBeforeItsTurnIsNeverWoven) {
    ChunkBudget budget(1000);
    Weave weave(session_, request({}, {newest(), std::nullopt}));
    weave.cancel();
    EXPECT_TRUE(weave.wait(std::chrono::milliseconds(0)));
    weave.run(log_, budget);
    EXPECT_EQ(weave.progress().state, State::kCancelled);
    EXPECT_EQ(weave.progress().woven, 0U);
    EXPECT_EQ(weave.maps(), nullptr);
}

/// A log that stops to think before an entry.
class SlowLog final : public store::MemoryScanLog {
public:
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        return MemoryScanLog::read(session, after, [&](Revision revision, std::string_view bytes) -> Result<> {
            if (revision == 10) {
                reached.set_value();
                go_on.get_future().wait();
            }
            return visit(revision, bytes);
        });
    }

    std::promise<void> reached;
    std::promise<void> go_on;
};

TEST_F(WeaveTest, OneCancelledOnTheWayEndsThereAndGivesBackItsChunks) {
    SlowLog slow;
    SessionInfo session;
    session.id = slow.create_session("s").value();
    std::vector<std::string> bytes;
    for (const auto& entry : entries_) bytes.push_back(wire::encode_entry(entry));
    slow.append(session.id, 1, std::move(bytes), [](const Result<>&) {});

    ChunkBudget budget(1000);
    Weave weave(session, request({}, {newest(), std::nullopt}));
    std::thread weaving([&] { weave.run(slow, budget); });
    slow.reached.get_future().wait();
    EXPECT_EQ(weave.progress().state, State::kWeaving);
    EXPECT_EQ(weave.progress().woven, 9U);
    EXPECT_FALSE(weave.wait(std::chrono::milliseconds(0)));
    weave.cancel();
    slow.go_on.set_value();
    weaving.join();
    EXPECT_EQ(weave.progress().state, State::kCancelled);
    EXPECT_EQ(weave.progress().woven, 9U);
    EXPECT_TRUE(budget.take(1000)) << "all of it is there again";
}

TEST_F(WeaveTest, MapsBeyondTheBudgetFailAndHoldNothing) {
    ChunkBudget budget(3);
    Weave weave(session_, request({.cell_size = 0.01}, {newest(), std::nullopt}));
    weave.run(log_, budget);
    EXPECT_EQ(weave.progress().state, State::kFailed);
    EXPECT_EQ(weave.progress().error->code, Errc::kFull);
    EXPECT_TRUE(budget.take(3));
}

TEST_F(WeaveTest, TheLeastRecentlyUsedGoWhenTheirChunksAreTooMany) {
    const auto chunks = woven(request({}, {newest(), std::nullopt}))->maps()->chunk_count;
    Weaves few(log_, pool_.get_executor(), {.chunks_kept_max = 3 * chunks});
    std::vector<std::string> ids;
    for (const double radius : {0.1, 0.2, 0.3}) {
        const auto weave = few.start(session_, request({.danger_radius = radius}, {newest(), std::nullopt})).value();
        EXPECT_TRUE(weave->wait(kLong));
        ids.push_back(weave->id());
    }
    EXPECT_NE(few.find(session_.id, ids[0]), nullptr) << "used again";
    const auto fourth = few.start(session_, request({.danger_radius = 0.4}, {newest(), std::nullopt})).value();
    EXPECT_TRUE(fourth->wait(kLong));
    EXPECT_NE(few.find(session_.id, fourth->id()), nullptr);
    EXPECT_NE(few.find(session_.id, ids[0]), nullptr);
    EXPECT_EQ(few.find(session_.id, ids[1]), nullptr);
    pool_.join();
}

TEST_F(WeaveTest, TooManyAtOnceAreRefusedAndNoneIsStartedAfterTheEnd) {
    boost::asio::thread_pool idle(1);
    std::promise<void> go_on;
    boost::asio::post(idle, [&] { go_on.get_future().wait(); });
    Weaves few(log_, idle.get_executor(), {.waiting_max = 2});
    EXPECT_TRUE(few.start(session_, request({}, {1, std::nullopt})));
    EXPECT_TRUE(few.start(session_, request({}, {2, std::nullopt})));
    EXPECT_EQ(few.start(session_, request({}, {3, std::nullopt})).error().code, Errc::kOverloaded);
    EXPECT_TRUE(few.start(session_, request({}, {1, std::nullopt}))) << "it is there already";
    few.stop();
    EXPECT_EQ(few.start(session_, request({}, {4, std::nullopt})).error().code, Errc::kShuttingDown);
    for (const auto& weave : few.list(session_.id)) EXPECT_EQ(weave->progress().state, State::kCancelled);
    go_on.set_value();
    idle.join();
}

} // namespace
} // namespace scanloom::session
