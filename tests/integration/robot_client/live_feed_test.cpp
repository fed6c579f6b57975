#include "robot_client/uplink/send_buffer.hpp"
#include "tests/integration/robot_client/live_feed_fixture.hpp"

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(LiveFeedTest, SendsAllScansOfASensor) {
    for (const bool spooled : {false, true}) {
        ScriptedSource source;
        source.allow(100);
        source.end();
        server_.forget();
        const auto outcome = run(source, spooled ? spool() : nullptr);
        EXPECT_TRUE(outcome) << outcome.error().message;
        expect_stored(100);
    }
    EXPECT_THAT(warnings_, IsEmpty());
    EXPECT_EQ(spool_files(), 0) << "acknowledged scans must leave the spool";
}

TEST_F(LiveFeedTest, SpoolsWithoutAServerAndSendsLater) {
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

TEST_F(LiveFeedTest, WithoutASpoolDropsTheOldestScansAndReportsIt) {
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
    EXPECT_EQ(server_.stored().back().pose->x, 1000.0);
    EXPECT_THAT(server_.faults(), IsEmpty()) << "numbers have no gaps";
    EXPECT_THAT(warnings_, testing::ElementsAre(HasSubstr("--spool keeps them on disk")));
}

TEST_F(LiveFeedTest, ASessionRecreatedBeforeAnyAckGetsAllScansOnce) {
    LinkScript first;
    first.ack_every = 1000;
    first.hang_up_after_scans = 18;
    LinkScript recreated;
    recreated.ack_every = 1000;
    recreated.session_id = "f2";
    server_.continue_with(first);
    bool is_recreated = false;
    server_.on_stored = [&](std::size_t stored) {
        if (!is_recreated && stored == 18) {
            is_recreated = true;
            server_.forget();
            server_.continue_with(recreated);
        } else if (is_recreated && stored == 10) {
            kill();
        }
    };
    ScriptedSource source;
    source.allow(18);
    EXPECT_FALSE(run(source, spool()));
    recreated.durable_seq = server_.stored().size();
    recreated.ack_every = 1;
    server_.continue_with(recreated);
    ScriptedSource next;
    next.given_ = 18;
    next.allow(25);
    next.end();
    const auto outcome = run(next, spool());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(25);
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(LiveFeedTest, WithFullMemoryEachScanIsKeptOrCounted) {
    server_.close();
    ScriptedSource source;
    source.large_from_ = 600;
    source.on_given = [&](std::uint64_t given) {
        if (given != 999) return;
        server_.reopen();
        source.end();
    };
    source.allow(1000);
    EXPECT_TRUE(run(source, nullptr));
    EXPECT_EQ(status_.dropped + server_.stored().size(), 1000U);
    std::size_t bytes = 0;
    for (const Scan& scan : server_.stored()) bytes += wire_bytes_max(scan);
    EXPECT_LE(bytes, 110'000U) << "the memory limit, plus one scan that arrives when memory is free again";
    EXPECT_EQ(server_.stored().back().pose->x, 1000.0) << "the newest scan is never dropped";
}

TEST_F(LiveFeedTest, TheNextProgramSendsTheScansOfAKilledOneOnce) {
    // Each is killed at another moment: before anything is sent, with scans in flight, with acknowledged scans.
    std::uint64_t taken = 0;
    for (const std::uint64_t until : {50U, 137U, 300U, 301U, 900U}) {
        if (until == 50) server_.close();
        ScriptedSource source;
        source.given_ = taken;
        source.on_given = [&](std::uint64_t given) {
            if (given == until) kill();
            taken = given - 1; // this scan was never returned
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
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(LiveFeedTest, ASpoolIsEmptyAfterALateEnd) {
    ScriptedSource source;
    source.allow(40);
    const std::function<void()> end_once_all_is_acknowledged = [&] {
        if (uplink_->status().acknowledged == 40) return source.end();
        asio::post(uplink_->executor(), end_once_all_is_acknowledged);
    };
    EXPECT_TRUE(run(source, spool(), end_once_all_is_acknowledged));
    EXPECT_EQ(spool_files(), 0);
}

TEST_F(LiveFeedTest, StoppingWithoutAServerReportsWaitingScansAndTheNextProgramSendsThem) {
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

TEST_F(LiveFeedTest, AFailedSensorIsReportedAfterItsScansAreStored) {
    for (const bool spooled : {false, true}) {
        ScriptedSource source;
        source.allow(30);
        source.fail();
        server_.forget();
        const auto outcome = run(source, spooled ? spool() : nullptr);
        ASSERT_FALSE(outcome);
        EXPECT_EQ(outcome.error().message, "the sensor failed");
        expect_stored(30);
    }
}

TEST_F(LiveFeedTest, APullSourceIsReadOnlyWhenThereIsSpaceWithoutLoss) {
    server_.close();
    ScriptedSource source;
    source.can_wait_ = true;
    source.allow(1000);
    source.end();
    const auto outcome = run(source, nullptr, [&] {
        EXPECT_EQ(source.given_, 0U) << "the server has not started";
        server_.reopen();
    });
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(1000);
    EXPECT_EQ(source.resumed_after_, 0U);
}

TEST_F(LiveFeedTest, APullSourceWaitsWhileTheServerIsUnreachable) {
    ScriptedSource source;
    source.can_wait_ = true;
    source.allow(1000);
    source.end();
    int turns_left = 5000; // executor turns: enough to take all scans, if they were taken
    const std::function<void()> reopen_later = [&] {
        if (turns_left-- == 0) return server_.reopen();
        asio::post(uplink_->executor(), reopen_later);
    };
    LinkScript hangs_up;
    hangs_up.hang_up_after_scans = 50;
    server_.continue_with(hangs_up);
    server_.on_stored = [&](std::size_t stored) {
        if (stored != 50) return;
        server_.continue_with({});
        server_.close();
        reopen_later();
    };
    const auto outcome = run(source, nullptr);
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_stored(1000);
}

TEST_F(LiveFeedTest, CanWaitUntilScansAreApplied) {
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
    EXPECT_GE(stored_when_applied, 39U) << "the last scan may not have reached the feed";
}

} // namespace
} // namespace scanloom::robot
