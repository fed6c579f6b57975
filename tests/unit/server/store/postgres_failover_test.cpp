#include "server/store/postgres_scan_log.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/postgres_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::store {
namespace {

using testing::HasSubstr;

constexpr Revision kEntriesMax = 6000; // of a session; far more than are stored before the primary is killed
constexpr std::size_t kSessions = 8;

/// The end of a session's log, as a client knows it.
struct Acknowledged {
    SessionId session = 0;
    std::atomic<Revision> end = 0;
};

/// A primary that is killed while entries are appended, and its standby, which is promoted.
TEST(PostgresFailoverTrials, ThePromotedStandbyHasEachAcknowledgedEntryOnce) {
    test::PostgresServer primary;
    auto address = primary.new_database();
    test::PostgresServer standby(primary);
    address += "," + standby.socket();
    const auto log = open_postgres(address, {.allow_unreplicated = true}).value();
    std::vector<Acknowledged> sessions(kSessions);
    for (Acknowledged& each : sessions) each.session = log->create_session("record").value();

    std::atomic<std::size_t> failed = 0;
    std::atomic<std::uint64_t> stored = 0;
    const std::function<void(Acknowledged&, Revision)> append_next = [&](Acknowledged& each, Revision first) {
        log->append(each.session, first, distinct_entries(each.session, first, 3), [&, first](const Result<>& done) {
            if (!done || first > kEntriesMax) {
                ++failed;
                return;
            }
            each.end = first + 2;
            ++stored;
            append_next(each, first + 3);
        });
    };
    for (Acknowledged& each : sessions) append_next(each, 1);
    while (stored < 100) {
    }
    primary.kill();
    while (failed < kSessions) {
    }
    EXPECT_FALSE(log->reopen());
    EXPECT_THAT(log->stats().last_error.value(), HasSubstr("is a standby"));
    standby.promote();
    while (!log->reopen()) {
    }

    for (const Acknowledged& each : sessions) {
        const auto end = log->end_of(each.session).value();
        EXPECT_GE(end, each.end);
        EXPECT_EQ(entries_after(*log, each.session, 0).value(), distinct_entries(each.session, 1, end));
        EXPECT_TRUE(append_and_wait(*log, each.session, end + 1, {"after the failover"}));
    }
}

TEST(PostgresFailoverTrials, AStoreThatIsNotUsedNoticesThatItsDatabaseIsGone) {
    test::PostgresServer database;
    const auto log = open_postgres(database.new_database(), {.allow_unreplicated = true}).value();
    database.kill();
    while (!log->stats().last_error) std::this_thread::yield();
    EXPECT_THAT(log->stats().last_error.value(), HasSubstr("cannot be used"));
}

} // namespace
} // namespace scanloom::store
