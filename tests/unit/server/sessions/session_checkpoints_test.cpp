#include "server/sessions/recovery.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <set>

/// When a session writes its checkpoints.
namespace scanloom::sessions {
namespace {

using testing::IsEmpty;

class SessionCheckpointsTest : public SessionTest {};

TEST_F(SessionCheckpointsTest, CheckpointIsWrittenEvery4096Entries) {
    const auto link = join("r");
    Scan scan = random_scan(1, 1);
    scan.ranges = {1000};
    std::uint64_t seq = 0;
    const auto submit = [&](std::size_t count) {
        std::vector<Scan> scans(count, scan);
        for (auto& next : scans) next.seq = ++seq;
        session_->submit(link, std::move(scans), 0);
        run();
    };
    for (int batch = 0; batch < 4; ++batch) submit(1000);
    EXPECT_THAT(store::checkpoint_of(log_, id_).value(), IsEmpty());
    submit(1000);
    EXPECT_EQ(recover(log_, id_, config_, false)->checkpointed, 4258U)
        << "the end of the first group after 4096 entries";
    for (int batch = 0; batch < 3; ++batch) submit(1000);
    EXPECT_EQ(recover(log_, id_, config_, false)->checkpointed, 4258U);
    submit(1000);
    auto recovered = recover(log_, id_, config_, false).value();
    EXPECT_EQ(recovered.checkpointed, 8514U);
    EXPECT_EQ(testing_support::digests_of(recovered.maps.projection().snapshot()), digest());
}

TEST_F(SessionCheckpointsTest, PendingCheckpointDoesNotDelayScans) {
    boost::asio::io_context slow; // executor for checkpoints; it runs when the test calls run()
    auto recovered = recover(log_, id_, config_, false).value();
    session_ = std::make_shared<Session>(SessionInfo{id_, "lab", 0.0, config_}, std::move(recovered.maps),
                                         recovered.checkpointed, log_, compute_.get_executor(), counters_, limits_,
                                         slow.get_executor());
    const auto link = join("r");
    for (std::uint64_t seq = 1; seq <= 20'000; seq += 1000) {
        std::vector<Scan> scans(1000, random_scan(1, 1));
        for (std::size_t n = 0; n < scans.size(); ++n) {
            scans[n].seq = seq + n;
            scans[n].ranges = {1000};
        }
        session_->submit(link, std::move(scans), 0);
        run();
        EXPECT_EQ(link->durable_seq(), seq + 999);
        EXPECT_EQ(session_->snapshot()->revision, seq + 1001);
    }
    EXPECT_THAT(store::checkpoint_of(log_, id_).value(), IsEmpty());
    slow.run();
    EXPECT_GT(recover(log_, id_, config_, false)->checkpointed, 4000U);
    run();
}

TEST_F(SessionCheckpointsTest, SessionsSpreadTheirCheckpoints) {
    std::set<Revision> written_at;
    for (int n = 0; n < 8; ++n) {
        SetUp();
        const auto link = join("r");
        std::uint64_t seq = 0;
        while (store::checkpoint_of(log_, id_).value().empty()) {
            std::vector<Scan> scans(256, random_scan(1, 1));
            for (auto& next : scans) {
                next.seq = ++seq;
                next.ranges = {1000};
            }
            session_->submit(link, std::move(scans), 0);
            run();
            ASSERT_LE(seq, 6400U);
        }
        written_at.insert(session_->snapshot()->revision);
    }
    EXPECT_GE(written_at.size(), 5U);
}

TEST_F(SessionCheckpointsTest, ClosingWithoutNewEntriesWritesNoCheckpoint) {
    const auto link = join("r");
    session_->close({Errc::kShuttingDown, "bye"}, [] {});
    run();
    start_session();
    log_.fail_from_next_change({Errc::kStoreFailed, "must not be written"});
    bool closed = false;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { closed = true; });
    run();
    EXPECT_TRUE(closed);
}

} // namespace
} // namespace scanloom::sessions
