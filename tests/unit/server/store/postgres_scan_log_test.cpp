#include "server/store/postgres_scan_log.hpp"

#include "server/store/open_store.hpp"
#include "server/store/shared_sessions.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/unit/server/store/postgres_database.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>

/// What a store in a database adds to the contract of ScanLog.
namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class PostgresScanLogTest : public testing::Test {
protected:
    [[nodiscard]] Result<std::unique_ptr<ScanLog>> open(const std::string& node = "a") const {
        return open_postgres(database_.address, {.allow_unreplicated = true, .node = node});
    }

    PostgresDatabase database_;
};

TEST_F(PostgresScanLogTest, AllIsThereAfterARestart) {
    SessionId session = 0;
    {
        const auto log = open().value();
        session = log->create_session("record").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, distinct_entries(session, 1, 500)));
        ASSERT_TRUE(log->write_checkpoint(session, {{"part", "value"}}));
    }
    const auto log = open().value();
    const auto sessions = log->sessions().value();
    ASSERT_THAT(sessions, SizeIs(1));
    EXPECT_EQ(sessions[0].record.value(), "record");
    EXPECT_EQ(log->end_of(session).value(), 500U);
    EXPECT_EQ(entries_after(*log, session, 0).value(), distinct_entries(session, 1, 500));
    EXPECT_EQ(checkpoint_of(*log, session).value().at("part"), "value");
    EXPECT_EQ(append_and_wait(*log, session, 501, {"next"}).error().code, Errc::kNotOwner);
    ASSERT_TRUE(own(*log, session));
    EXPECT_TRUE(append_and_wait(*log, session, 501, {"next"}));
}

TEST_F(PostgresScanLogTest, TheDestructorStoresWhatIsQueued) {
    SessionId session = 0;
    std::atomic<int> done = 0;
    {
        const auto log = open().value();
        session = log->create_session("").value();
        for (Revision revision = 1; revision <= 100; ++revision) {
            log->append(session, revision, distinct_entries(session, revision, 1),
                        [&](Result<> result) { done += result ? 1 : 0; });
        }
    }
    EXPECT_EQ(done, 100);
    EXPECT_EQ(open().value()->end_of(session).value(), 100U);
}

TEST_F(PostgresScanLogTest, ConnectionsThatEndedBetweenChangesAreOpenedAgain) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"a"}));
    EXPECT_EQ(entries_after(*log, session, 0).value().size(), 1U);
    database_.end_connections();
    EXPECT_TRUE(append_and_wait(*log, session, 2, {"b"}));
    EXPECT_EQ(open_store_read_only(database_.address).error().code, Errc::kConflict) << "a server has it open";
    EXPECT_TRUE(log->write_checkpoint(session, {{"part", "value"}}));
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("a", "b"));
}

/// A new connection costs the database milliseconds, and a server that starts reads the begin of all checkpoints.
TEST_F(PostgresScanLogTest, AReaderThatStopsEarlyLeavesItsConnectionToTheNext) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"a", "b"}));
    ASSERT_TRUE(log->write_checkpoint(session, {{"a", "1"}, {"b", "2"}}));
    const Error stop{Errc::kGone, "enough"};
    const auto read_begins = [&] {
        EXPECT_EQ(log->read_checkpoint(session, [&](auto, auto) { return stop; }).error(), stop);
        EXPECT_TRUE(log->read(session, 0, [](auto, auto) { return Visit::kStop; }));
    };
    auto watching = test::connect(database_.address);
    const auto reader = [&] {
        return watching
            .run("SELECT coalesce(max(pid), 0) FROM pg_stat_activity WHERE datname = current_database()"
                 " AND state = 'idle' AND query LIKE 'SELECT first, last, body%'")
            .value()
            .number(0, 0);
    };
    read_begins();
    const auto first = reader();
    EXPECT_NE(first, 0);
    read_begins();
    EXPECT_EQ(reader(), first);
}

TEST_F(PostgresScanLogTest, ADatabaseThatWentBackIsNoticed) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"a", "b"}));
    static_cast<void>(database_.run("UPDATE scanloom.session SET end_rev = 1"));
    static_cast<void>(database_.run("DELETE FROM scanloom.segment WHERE last > 1"));
    EXPECT_FALSE(append_and_wait(*log, session, 3, {"c"}));
    EXPECT_FALSE(log->reopen());
    EXPECT_THAT(log->stats().last_error.value(),
                HasSubstr("has lost entries: session 1 ends with 1, and 2 was acknowledged"));
}

TEST_F(PostgresScanLogTest, DamageIsReportedWithSessionAndRevision) {
    const auto log = open().value();
    std::vector<SessionId> sessions;
    for (int n = 0; n < 3; ++n) {
        sessions.push_back(log->create_session("").value());
        ASSERT_TRUE(append_and_wait(*log, sessions.back(), 1, distinct_entries(sessions.back(), 1, 100)));
        ASSERT_TRUE(log->write_checkpoint(sessions.back(), {{"part", "value"}}));
    }
    static_cast<void>(database_.run("UPDATE scanloom.segment SET body = set_byte(body, 9, get_byte(body, 9) # 1)"
                                    " WHERE session = 1 AND first > 1"));
    static_cast<void>(database_.run("DELETE FROM scanloom.segment WHERE session = 2 AND first > 1"));
    static_cast<void>(database_.run("UPDATE scanloom.part SET value = 'another value' WHERE session = 1"));
    EXPECT_EQ(entries_after(*log, sessions[0], 0).error().code, Errc::kDataLoss);
    EXPECT_THAT(entries_after(*log, sessions[0], 0).error().message, HasSubstr("of session 1"));
    EXPECT_THAT(entries_after(*log, sessions[1], 0).error().message, HasSubstr("is missing of session 2"));
    EXPECT_EQ(checkpoint_of(*log, sessions[0]).error().code, Errc::kDataLoss);
    EXPECT_EQ(entries_after(*log, sessions[2], 0).value(), distinct_entries(sessions[2], 1, 100));
}

TEST_F(PostgresScanLogTest, AStoreOpenedForReadingIsNotChanged) {
    EXPECT_EQ(open_store_read_only(database_.address).error().code, Errc::kNotFound);
    SessionId session = 0;
    {
        const auto log = open().value();
        session = log->create_session("record").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, distinct_entries(session, 1, 50)));
        ASSERT_TRUE(log->write_checkpoint(session, {{"part", "value"}}));
        EXPECT_EQ(open_store_read_only(database_.address).error().code, Errc::kConflict) << "a server has it open";
    }
    static_cast<void>(database_.run("INSERT INTO scanloom.part VALUES (77, '', '')"));
    const auto state = [&] {
        return std::string(database_.run("SELECT string_agg(s::text, ' ') FROM scanloom.session s").bytes(0, 0));
    };
    const auto before = state();
    {
        const auto store = open_store_read_only(database_.address).value();
        EXPECT_THAT(store.without_record, ElementsAre(77));
        EXPECT_THAT(store.log->sessions().value(), SizeIs(1));
        EXPECT_EQ(entries_after(*store.log, session, 0).value(), distinct_entries(session, 1, 50));
        EXPECT_EQ(checkpoint_of(*store.log, session).value().at("part"), "value");
        EXPECT_FALSE(append_and_wait(*store.log, session, 51, {"x"}));
        EXPECT_FALSE(store.log->create_session(""));
        EXPECT_FALSE(store.log->remove_session(session));
        EXPECT_FALSE(store.log->reopen());
    }
    EXPECT_EQ(state(), before);
}

TEST_F(PostgresScanLogTest, RowsOfARemovedSessionAreDeletedByTheNextServerAtTheLatest) {
    {
        const auto log = open().value();
        for (int n = 0; n < 2; ++n) {
            const auto session = log->create_session("").value();
            ASSERT_TRUE(append_and_wait(*log, session, 1, {"a"}));
            ASSERT_TRUE(log->write_checkpoint(session, {{"part", "value"}}));
        }
        static_cast<void>(database_.run("UPDATE scanloom.session SET removed = true WHERE id = 1"));
    }
    static_cast<void>(
        database_.run("INSERT INTO scanloom.segment SELECT 1, n, n, '' FROM generate_series(2, 10001) n"));
    const auto log = open().value();
    while (database_.number("SELECT count(*) FROM scanloom.session") > 1) {
    }
    EXPECT_EQ(database_.number("SELECT count(*) FROM scanloom.segment"), 1);
    EXPECT_EQ(database_.number("SELECT count(*) FROM scanloom.part"), 1);
    EXPECT_THAT(log->sessions().value(), SizeIs(1));
}

/// PostgreSQL reports a commit as done if the wait for its standby was cancelled.
TEST_F(PostgresScanLogTest, ACommitWithoutTheConsentOfTheStandbyIsNoAcknowledgement) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"a"}));
    const auto name_standby = [&](const std::string& name) {
        static_cast<void>(database_.run("ALTER SYSTEM SET synchronous_standby_names = '" + name + "'"));
        static_cast<void>(database_.run("SELECT pg_reload_conf()"));
        while (database_.run("SELECT current_setting('synchronous_standby_names')").bytes(0, 0) != name) {
        }
    };
    name_standby("absent");
    std::promise<Result<>> outcome;
    log->append(session, 2, {"b"}, [&](Result<> result) { outcome.set_value(std::move(result)); });
    while (database_.number(
               "SELECT count(pg_cancel_backend(pid)) FROM pg_stat_activity WHERE wait_event = 'SyncRep'") == 0) {
    }
    const auto appended = outcome.get_future().get();
    name_standby("");
    ASSERT_FALSE(appended);
    EXPECT_EQ(appended.error().code, Errc::kStoreFailed);
    EXPECT_THAT(appended.error().message, HasSubstr("canceling wait for synchronous replication"));
    ASSERT_TRUE(log->reopen());
    EXPECT_EQ(log->end_of(session).value(), 2U) << "it was stored, which the next commit makes durable";
    EXPECT_TRUE(append_and_wait(*log, session, 3, {"c"}));
}

TEST_F(PostgresScanLogTest, NothingIsAddedAboveTheSizeLimitUntilSessionsAreRemoved) {
    const PostgresOptions options{.allow_unreplicated = true, .bytes_max = 100'000};
    const std::string large(60'000, 'a');
    SessionId removed = 0;
    SessionId kept = 0;
    {
        const auto log = open_postgres(database_.address, options).value();
        removed = log->create_session("").value();
        kept = log->create_session("").value();
        EXPECT_TRUE(append_and_wait(*log, removed, 1, {large}));
        EXPECT_TRUE(log->write_checkpoint(kept, {{"part", large}}));
        EXPECT_EQ(append_and_wait(*log, kept, 1, {"a"}).error().code, Errc::kOverloaded) << "counts what it stores";
    }
    const auto log = open_postgres(database_.address, options).value(); // asks the database
    for (const auto session : {removed, kept}) ASSERT_TRUE(own(*log, session));
    const auto refused = append_and_wait(*log, kept, 1, {"a"});
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    EXPECT_THAT(refused.error().message, HasSubstr("--store-size-max"));
    EXPECT_EQ(log->stats().no_room, refused.error().message);
    EXPECT_EQ(log->write_checkpoint(kept, {{"part", "x"}}).error().code, Errc::kOverloaded);
    EXPECT_EQ(log->create_session("").error().code, Errc::kOverloaded);
    EXPECT_THAT(entries_after(*log, removed, 0).value(), ElementsAre(large));
    EXPECT_EQ(checkpoint_of(*log, kept).value().at("part"), large);

    ASSERT_TRUE(log->remove_session(removed));
    while (!append_and_wait(*log, kept, 1, {"a"})) { // until its rows are deleted
    }
    EXPECT_FALSE(log->stats().no_room);
    EXPECT_TRUE(log->clear_checkpoint(kept));
}

TEST_F(PostgresScanLogTest, AnUnreplicatedDatabaseIsRefusedUnlessAllowed) {
    const auto log = open_postgres(database_.address);
    ASSERT_FALSE(log);
    EXPECT_EQ(log.error().code, Errc::kStoreFailed);
    EXPECT_THAT(log.error().message, HasSubstr("no synchronous standby"));
    EXPECT_THAT(log.error().message, HasSubstr("--allow-unreplicated"));
    EXPECT_EQ(database_.number("SELECT count(*) FROM pg_namespace WHERE nspname = 'scanloom'"), 0)
        << "nothing is created";
    EXPECT_THAT(open().value()->stats().warning.value(), HasSubstr("no synchronous standby"));
}

/// A connection that was opened again writes only where the first one would.
TEST_F(PostgresScanLogTest, NothingIsWrittenWhileAnotherProgramHasTheStoreAlone) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    std::optional<postgres::Connection> other;
    do { // until it is faster than the log's own thread
        database_.end_connections();
        other = test::connect(database_.address);
    } while (other->run("SELECT pg_try_advisory_lock(hashtext('scanloom'), 1)::int::bigint").value().number(0, 0) == 0);
    const auto refused = append_and_wait(*log, session, 1, {"a"});
    EXPECT_EQ(refused.error().code, Errc::kStoreFailed);
    EXPECT_THAT(refused.error().message, HasSubstr("another program uses the store"));
    EXPECT_THAT(open("b").error().message, HasSubstr("stop it, or name another database"));
    EXPECT_FALSE(log->reopen());
    other->run("SELECT pg_advisory_unlock(hashtext('scanloom'), 1)").value();
    ASSERT_TRUE(log->reopen());
    EXPECT_TRUE(append_and_wait(*log, session, 1, {"a"}));
}

TEST_F(PostgresScanLogTest, SeveralServersMayCreateTheStoreAtOnce) {
    std::vector<std::future<bool>> opened;
    for (const char* node : {"a", "b", "c"}) {
        opened.push_back(std::async(std::launch::async, [this, node] { return open(node).has_value(); }));
    }
    for (auto& one : opened) EXPECT_TRUE(one.get());
}

TEST_F(PostgresScanLogTest, ADatabaseWithoutRoomRefusesAndGoesOnLater) {
    const auto log = open().value();
    const auto session = log->create_session("").value();
    database_.fail_next_insertion("53100"); // disk_full
    const auto refused = append_and_wait(*log, session, 1, {"a"});
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    EXPECT_EQ(log->stats().no_room, refused.error().message);
    EXPECT_TRUE(append_and_wait(*log, session, 1, {"a"}));
    EXPECT_FALSE(log->stats().no_room);
}

TEST_F(PostgresScanLogTest, AWrongPasswordIsReported) {
    static_cast<void>(database_.run("DROP ROLE IF EXISTS locked"));
    static_cast<void>(database_.run("CREATE ROLE locked LOGIN PASSWORD 'right'"));
    std::string url = database_.address;
    url.replace(url.find("scanloom@"), 8, "locked:wrong");
    const auto refused = open_postgres(url);
    EXPECT_EQ(refused.error().code, Errc::kStoreFailed);
    EXPECT_THAT(refused.error().message, HasSubstr("password authentication failed for user \"locked\""));
}

TEST_F(PostgresScanLogTest, AStoreOfANewerProgramIsRefused) {
    { ASSERT_TRUE(open()); }
    static_cast<void>(database_.run("UPDATE scanloom.meta SET value = '99' WHERE key = 'format'"));
    const auto log = open();
    EXPECT_EQ(log.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(log.error().message, HasSubstr("format 99"));
}

TEST_F(PostgresScanLogTest, AReadOnlyDatabaseIsRefused) {
    const PostgresDatabase another(PostgresDatabase::server().new_database());
    const std::string name(another.run("SELECT current_database()::text").bytes(0, 0));
    static_cast<void>(another.run("ALTER DATABASE " + name + " SET default_transaction_read_only = on"));
    EXPECT_THAT(open_postgres(another.address).error().message, HasSubstr("is read-only"));
}

TEST_F(PostgresScanLogTest, ReasonsOfAllHostsAreNamed) {
    const auto log = open_postgres("postgresql://someone:secret@127.0.0.1:1,127.0.0.1:2/none");
    EXPECT_EQ(log.error().code, Errc::kStoreFailed);
    EXPECT_THAT(log.error().message, HasSubstr("postgresql://someone@127.0.0.1,127.0.0.1/none"));
    EXPECT_THAT(log.error().message, HasSubstr("port 1 failed"));
    EXPECT_THAT(log.error().message, HasSubstr("port 2 failed"));
    EXPECT_THAT(log.error().message, Not(HasSubstr("secret")));
}

TEST(PostgresVersion, BelowFifteenIsRefused) {
    namespace asio = boost::asio;
    asio::io_context io;
    asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    const auto port = acceptor.local_endpoint().port();
    const std::jthread server([&] {
        auto socket = acceptor.accept();
        std::array<char, 1024> received;
        static_cast<void>(socket.read_some(asio::buffer(received)));
        using namespace std::string_literals;
        const auto welcome = "R\0\0\0\x08\0\0\0\0"s // no password is needed
                             "S\0\0\0\x18server_version\0"s
                             "14.2\0"s
                             "Z\0\0\0\x05I"s; // ready for queries
        asio::write(socket, asio::buffer(welcome));
        boost::system::error_code ended;
        asio::read(socket, asio::buffer(received), ended);
    });
    const auto refused =
        open_postgres(fmt::format("postgresql://a@127.0.0.1:{}/b?sslmode=disable&gssencmode=disable", port));
    EXPECT_EQ(refused.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(refused.error().message, HasSubstr("has PostgreSQL 14; version 15 or a newer one is needed"));
}

TEST(StoreAddress, IsCheckedAndShownWithoutItsPassword) {
    EXPECT_TRUE(is_in_database("postgresql://a@b/c"));
    EXPECT_TRUE(is_in_database("postgres://a@b/c"));
    EXPECT_FALSE(is_in_database("/var/lib/scanloom"));
    EXPECT_TRUE(check_address("postgresql://a:secret@b:1,c:2/d?sslmode=verify-full"));
    EXPECT_THAT(check_address("postgresql://a@b").error().message, HasSubstr("names no database"));
    EXPECT_THAT(check_address("postgresql://a@b/c?colour=red").error().message, HasSubstr("colour"));
    EXPECT_THAT(check_address("postgresql://a@b:1,c:2,d/e?port=1,2").error().message, HasSubstr("3 hosts and 2 ports"));
    EXPECT_EQ(shown("postgresql://a:secret@b:1,c:2/d"), "postgresql://a@b,c/d");
    EXPECT_EQ(shown("/var/lib/scanloom"), "/var/lib/scanloom");
}

} // namespace
} // namespace scanloom::store
