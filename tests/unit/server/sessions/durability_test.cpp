#include "tests/unit/server/sessions/session_fixture.hpp"

/// Maps and acknowledgements contain only durable entries; entries that cannot become durable have no effect.
namespace scanloom::sessions {
namespace {

using testing::Each;
using testing::IsEmpty;
using testing::SizeIs;

TEST_F(SessionTest, EntriesAreVisibleAndAcknowledgedOnlyAfterTheyAreDurable) {
    const auto link = join("r");
    const auto before = session_->snapshot();
    const auto acks_before = link->durable_seqs.size();
    log_.hold_completions();
    session_->submit(link, random_scans(1, 1, 5), 50);
    run();
    EXPECT_EQ(log_.held_completions(), 1U);
    EXPECT_EQ(session_->snapshot(), before);
    EXPECT_EQ(link->durable_seqs.size(), acks_before);
    EXPECT_EQ(link->bytes_released, 0U);
    log_.release_completions();
    run();
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 5U);
    EXPECT_EQ(link->durable_seq(), 5U);
    EXPECT_EQ(link->bytes_released, 50U);
    EXPECT_EQ(before->robots[0].last_seq, 0U) << "snapshots do not change";
}

/// A link that reads the map when scans are acknowledged.
struct WatchingLink : RecordedLink {
    explicit WatchingLink(const Session& session) : watched(session) {}

    void on_durable(std::uint64_t seq, std::size_t bytes) override {
        RecordedLink::on_durable(seq, bytes);
        seqs_in_map.push_back(watched.snapshot()->robots.at(0).last_seq);
    }

    const Session& watched;
    std::vector<std::uint64_t> seqs_in_map;
};

TEST_F(SessionTest, AcknowledgedScansAreInTheMap) {
    const auto link = std::make_shared<WatchingLink>(*session_);
    session_->join({"r"}, link, [](const Result<Joined>&) {});
    run();
    session_->submit(link, small_laser(), 0);
    for (std::uint64_t seq = 1; seq <= 600; ++seq) session_->submit(link, {random_scan(1, seq)}, 10);
    run();
    EXPECT_EQ(link->durable_seq(), 600U);
    EXPECT_EQ(link->seqs_in_map, link->durable_seqs);
}

TEST_F(SessionTest, ScansRefusedByAFullDiskAreAcceptedLater) {
    const auto link = join("r");
    session_->submit(link, random_scans(1, 1, 5), 10);
    run();
    log_.refuse_appends(1);
    session_->submit(link, random_scans(1, 6, 5), 10);
    session_->submit(link, random_scans(1, 11, 5), 10);
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_EQ(link->failures[0].code, Errc::kOverloaded);
    EXPECT_FALSE(session_->failure()) << "the log's contents are known";
    EXPECT_EQ(link->durable_seq(), 5U);
    EXPECT_TRUE(begin_join("new").answer->value()) << "the join is not stored either";
    run();

    const auto again = begin_join("r");
    EXPECT_EQ(again.answer->value()->last_durable_seq, 5U);
    session_->submit(again.link, random_scans(1, 6, 10), 10);
    run();
    EXPECT_EQ(again.link->durable_seq(), 15U);
    EXPECT_THAT(again.link->failures, IsEmpty());
    EXPECT_EQ(digest(), digest_of_log());
    EXPECT_EQ(session_->snapshot()->robots.size(), 2U);
}

TEST_F(SessionTest, DurableScansAreIntegratedWhenTheDiskIsFull) {
    const auto link = join("r");
    for (std::uint64_t seq = 1; seq <= 600; ++seq) session_->submit(link, {random_scan(1, seq)}, 10);
    log_.refuse_appends(1, 1); // the second of three appends
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    const auto again = begin_join("r");
    const auto durable = again.answer->value()->last_durable_seq;
    EXPECT_GT(durable, 0U);
    EXPECT_LT(durable, 600U);
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, durable);
    session_->submit(again.link, random_scans(1, durable + 1, 600 - durable), 10);
    run();
    EXPECT_EQ(again.link->durable_seq(), 600U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(SessionTest, EntriesSubmittedDuringAnAppendAreAppendedTogether) {
    const auto link = join("r");
    const auto appends = log_.stats().appends;
    log_.hold_completions();
    for (std::uint64_t seq = 1; seq <= 200; ++seq) session_->submit(link, {random_scan(1, seq)}, 10);
    run();
    EXPECT_EQ(log_.held_completions(), 1U) << "one append is under way";
    EXPECT_EQ(session_->backlog_size(), 199U) << "the other entries wait";
    log_.release_completions();
    run();
    EXPECT_EQ(log_.stats().appends, appends + 2);
    EXPECT_EQ(link->durable_seq(), 200U);
    EXPECT_EQ(session_->backlog_size(), 0U);
    EXPECT_EQ(link->bytes_released, 2000U);
    EXPECT_THAT(link->durable_seqs, SizeIs(testing::Le(4U))) << "one acknowledgement per group";
}

TEST_F(SessionTest, AppendedGroupsAreBounded) {
    const auto link = join("r");
    const auto appends = log_.stats().appends;
    log_.hold_completions();
    session_->submit(link, random_scans(1, 1, 1), 10);
    for (std::uint64_t seq = 2; seq <= 1001; ++seq) session_->submit(link, {random_scan(1, seq)}, 10);
    run();
    log_.release_completions();
    run();
    EXPECT_EQ(log_.stats().appends, appends + 1 + 4) << "1000 entries need four groups of 256";
    EXPECT_EQ(link->durable_seq(), 1001U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(SessionTest, RejoiningWaitsForTheEarlierLinksScans) {
    const auto first = join("r");
    log_.hold_completions();
    session_->submit(first, random_scans(1, 1, 5), 50);
    session_->leave(first);
    const auto again = begin_join("r");
    EXPECT_FALSE(again.answer->has_value());
    log_.release_completions();
    run();
    ASSERT_TRUE(again.answer->has_value());
    EXPECT_EQ(again.answer->value().value().last_durable_seq, 5U);
    EXPECT_EQ(again.link->bytes_released, 0U) << "the credit belonged to the earlier link";
    EXPECT_THAT(again.link->durable_seqs, IsEmpty());
}

TEST_F(SessionTest, LaterOfTwoWaitingLinksJoins) {
    const auto first = join("r");
    log_.hold_completions();
    session_->submit(first, random_scans(1, 1, 5), 50);
    const auto second = begin_join("r");
    const auto third = begin_join("r");
    EXPECT_EQ(first->failures.at(0).code, Errc::kReplaced);
    ASSERT_TRUE(second.answer->has_value());
    EXPECT_EQ(second.answer->value().error().code, Errc::kReplaced);
    log_.release_completions();
    run();
    EXPECT_EQ(third.answer->value().value().last_durable_seq, 5U);
}

TEST_F(SessionTest, FailedAppendFailsEveryLinkAndKeepsTheMaps) {
    const auto a = join("a");
    const auto b = join("b");
    session_->submit(a, random_scans(1, 1, 3), 10);
    run();
    const auto good = session_->snapshot();
    EXPECT_FALSE(session_->failure());
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    session_->submit(a, random_scans(1, 4, 3), 10);
    session_->submit(b, random_scans(2, 1, 3), 10);
    run();
    for (const auto& link : {a, b}) {
        ASSERT_THAT(link->failures, SizeIs(1));
        EXPECT_EQ(link->failures[0], (Error{Errc::kStoreFailed, "no space left"}));
    }
    EXPECT_EQ(a->durable_seq(), 3U);
    EXPECT_EQ(b->durable_seq(), 0U);
    EXPECT_EQ(session_->snapshot(), good);
    EXPECT_EQ(session_->failure(), (Error{Errc::kStoreFailed, "no space left"}));
    EXPECT_FALSE(session_->is_connected(0));
    const auto refused = begin_join("a");
    EXPECT_EQ(refused.answer->value().error().code, Errc::kStoreFailed);
}

TEST_F(SessionTest, RestartAfterAFailedDiskContinuesExactly) {
    auto link = join("r");
    session_->submit(link, random_scans(1, 1, 3), 10);
    run();
    log_.hold_completions();
    session_->submit(link, random_scans(1, 4, 2), 10);
    run();
    session_->submit(link, random_scans(1, 6, 2), 10);
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    log_.release_completions();
    run();
    EXPECT_EQ(link->durable_seq(), 3U);

    log_.reopen();
    start_session();
    const auto again = begin_join("r");
    EXPECT_EQ(again.answer->value().value().last_durable_seq, 3U);
    session_->submit(again.link, random_scans(1, 4, 10), 10);
    run();
    EXPECT_EQ(again.link->durable_seq(), 13U);
    EXPECT_EQ(session_->snapshot()->robots[0].scan_count, 13U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(SessionTest, JoinThatIsNotDurableHasNoEffect) {
    log_.hold_completions();
    const auto lost = begin_join("lost");
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    log_.release_completions();
    run();
    EXPECT_EQ(lost.answer->value().error().code, Errc::kStoreFailed);
    log_.reopen();
    start_session();
    EXPECT_EQ(begin_join("other").answer->value().value().robot, 0U);
}

TEST_F(SessionTest, ClosingDrainsThenFailsEveryLink) {
    const auto link = join("r");
    log_.hold_completions();
    session_->submit(link, random_scans(1, 1, 300), 10);
    session_->submit(link, random_scans(1, 301, 5), 10);
    const auto waiting = begin_join("r2");
    bool closed = false;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { closed = true; });
    run();
    EXPECT_FALSE(closed);
    EXPECT_THAT(link->failures, IsEmpty()) << "acknowledgements precede the failure";
    session_->submit(link, random_scans(1, 306, 5), 10); // too late: the session is closing
    log_.release_completions();
    run();
    EXPECT_TRUE(closed);
    EXPECT_EQ(link->durable_seq(), 305U);
    EXPECT_THAT(link->failures, testing::ElementsAre(Error{Errc::kShuttingDown, "bye"}));
    EXPECT_TRUE(waiting.answer->has_value());
    EXPECT_EQ(begin_join("late").answer->value().error().code, Errc::kShuttingDown);
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 305U);
    EXPECT_FALSE(store::checkpoint_of(log_, id_).value().empty());
}

TEST_F(SessionTest, ClosingCompletesAfterADiskFailure) {
    const auto link = join("r");
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    session_->submit(link, random_scans(1, 1, 3), 10);
    int closed = 0;
    session_->close({Errc::kShuttingDown, "bye"}, [&] { ++closed; });
    run();
    EXPECT_EQ(closed, 1);
    session_->close({Errc::kShuttingDown, "bye again"}, [&] { ++closed; });
    run();
    EXPECT_EQ(closed, 2);
    EXPECT_THAT(store::checkpoint_of(log_, id_).value(), IsEmpty());
}

TEST_F(SessionTest, ForeignLogEntryStopsTheSession) {
    const auto link = join("r");
    ASSERT_TRUE(store::append_and_wait(log_, id_, 3, {"another writer's"}));
    session_->submit(link, random_scans(1, 1, 1), 10);
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_EQ(link->failures[0].code, Errc::kConflict);
    EXPECT_EQ(session_->snapshot()->revision, 2U);
}

TEST_F(SessionTest, DiscardedSessionStopsWriting) {
    const auto link = join("r");
    session_->submit(link, random_scans(1, 1, 300), 10);
    run();
    log_.hold_completions();
    session_->submit(link, random_scans(1, 301, 10), 10);
    session_->submit(link, random_scans(1, 311, 600), 10);
    run();
    const auto appends = log_.held_completions();
    bool closed = false;
    session_->close_early({Errc::kGone, "deleted"}, [&] { closed = true; });
    log_.release_completions();
    run();
    EXPECT_TRUE(closed);
    EXPECT_EQ(appends, 1U);
    EXPECT_THAT(logged(), SizeIs(312)) << "waiting entries are not appended";
    EXPECT_THAT(store::checkpoint_of(log_, id_).value(), IsEmpty());
    EXPECT_THAT(link->failures, testing::ElementsAre(Error{Errc::kGone, "deleted"}));
}

} // namespace
} // namespace scanloom::sessions
