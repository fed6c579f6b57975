#include "server/store/postgres_ownership.hpp"

#include "common/wire/log_codec.hpp"
#include "server/store/shared_sessions.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/unit/server/store/postgres_database.hpp"
#include "tests/unit/server/store/races.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <thread>

/// Servers that share a store in a database.
namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Key;
using testing::SizeIs;

std::string record_of(const std::string& name, SessionId replaces = 0) {
    wire::SessionRecord record{.name = name};
    record.replaces = replaces;
    return wire::encode_session(record);
}

class PostgresOwnershipTest : public testing::Test {
protected:
    [[nodiscard]] std::unique_ptr<ScanLog> open(const std::string& node) const {
        return open_postgres(database_.address, {.allow_unreplicated = true, .node = node}).value();
    }

    [[nodiscard]] std::string state_of_sessions() const {
        return std::string(database_.run("SELECT string_agg(s::text, ' ') FROM scanloom.session s").bytes(0, 0));
    }

    PostgresDatabase database_;
};

TEST_F(PostgresOwnershipTest, ASessionIsChangedByItsOwnerAlone) {
    const auto a = open("a");
    const auto b = open("b");
    ASSERT_TRUE(a->shared()->announce({.robots = "robots:1", .http = "http://web:2", .build = "1.0"}));
    const auto session = a->create_session(record_of("s")).value();
    ASSERT_TRUE(append_and_wait(*a, session, 1, {"of a"}));
    const auto before = state_of_sessions();

    const auto owned = own(*b, session);
    EXPECT_EQ(owned.error().code, Errc::kNotOwner);
    EXPECT_THAT(owned.error().message, HasSubstr("belongs to node a at http://web:2"));
    EXPECT_EQ(append_and_wait(*b, session, 2, {"of b"}).error().code, Errc::kNotOwner);
    EXPECT_EQ(b->write_checkpoint(session, {{"part", "of b"}}).error().code, Errc::kNotOwner);
    EXPECT_EQ(b->clear_checkpoint(session).error().code, Errc::kNotOwner);
    EXPECT_EQ(b->remove_session(session).error().code, Errc::kNotOwner);
    EXPECT_EQ(state_of_sessions(), before);
    EXPECT_THAT(entries_after(*b, session, 0).value(), ElementsAre("of a")) << "reading needs no ownership";
    EXPECT_FALSE(b->stats().last_error);

    ASSERT_TRUE(a->shared()->disown(session));
    EXPECT_EQ(append_and_wait(*a, session, 2, {"late"}).error().code, Errc::kNotOwner);
    ASSERT_TRUE(own(*b, session));
    EXPECT_TRUE(append_and_wait(*b, session, 2, {"of b"}));
    EXPECT_EQ(own(*a, session).error().code, Errc::kNotOwner);
    EXPECT_EQ(own(*b, 77).error().code, Errc::kNotFound);
}

TEST_F(PostgresOwnershipTest, ServersKnowEachOtherAndWhoHasWhichSession) {
    const auto a = open("a");
    const auto b = open("b");
    ASSERT_TRUE(a->shared()->announce({.robots = "robots:1", .http = "http://web:2", .build = "1.0"}));
    const auto of_a = a->create_session(record_of("of_a")).value();
    const auto of_b = b->create_session(record_of("of_b")).value();
    ASSERT_TRUE(append_and_wait(*a, of_a, 1, {"x", "y"}));
    const auto list = b->shared()->list().value();
    ASSERT_THAT(list.nodes, SizeIs(2));
    EXPECT_EQ(list.nodes[0].info->name, "a");
    EXPECT_EQ(list.nodes[0].info->http, "http://web:2");
    EXPECT_TRUE(list.nodes[0].is_alive && !list.nodes[0].is_self);
    EXPECT_TRUE(list.nodes[1].is_alive && list.nodes[1].is_self);
    EXPECT_EQ(list.nodes[0].sessions, 1U);
    EXPECT_EQ(list.sessions.at(of_a).end, 2U);
    EXPECT_EQ(list.sessions.at(of_a).owner->robots, "robots:1");
    EXPECT_EQ(list.sessions.at(of_b).owner, nullptr) << "this server has it";
    EXPECT_EQ(b->shared()->find("of_a").value().value().shared.owner->build, "1.0");
    static_cast<void>(database_.run("UPDATE scanloom.node SET seen = now() - interval '6 s' WHERE name = 'a'"));
    const auto later = b->shared()->list().value();
    EXPECT_EQ(later.sessions.at(of_a).owner == nullptr, !later.nodes[0].is_alive);
}

/// As of a server that was paused while its sessions were taken.
TEST_F(PostgresOwnershipTest, EachKindOfLateChangeFailsForItsSessionAlone) {
    using Change = Result<> (*)(ScanLog&, SessionId);
    constexpr std::array<Change, 4> kChanges = {
        [](ScanLog& log, SessionId id) { return append_and_wait(log, id, 1, {"x"}); },
        [](ScanLog& log, SessionId id) {
            return log.write_checkpoint(id, {{"part", "x"}});
        },
        [](ScanLog& log, SessionId id) { return log.clear_checkpoint(id); },
        [](ScanLog& log, SessionId id) { return log.remove_session(id); }};
    const auto paused = open("paused");
    const auto kept = paused->create_session("").value();
    for (const Change change : kChanges) {
        const auto session = paused->create_session("").value();
        ASSERT_TRUE(paused->write_checkpoint(session, {{"kept", "value"}}));
        static_cast<void>(database_.run("UPDATE scanloom.session SET epoch = epoch + 1, owner = 0 WHERE id = " +
                                        std::to_string(session)));
        const auto before = state_of_sessions();
        EXPECT_EQ(change(*paused, session).error().code, Errc::kNotOwner);
        EXPECT_EQ(state_of_sessions(), before);
        EXPECT_EQ(checkpoint_of(*paused, session).value().at("kept"), "value");
    }
    EXPECT_FALSE(paused->stats().last_error);
    EXPECT_TRUE(append_and_wait(*paused, kept, 1, {"a"}));
}

TEST_F(PostgresOwnershipTest, SessionsOfDeadNodesAreTakenByNodesThatLive) {
    const auto log = open("a");
    const auto session = log->create_session("").value();
    ASSERT_TRUE(log->shared()->disown(session));
    static_cast<void>(database_.run("INSERT INTO scanloom.node (name, seen) VALUES ('other', now())"));
    static_cast<void>(
        database_.run("UPDATE scanloom.session SET owner = (SELECT id FROM scanloom.node WHERE name = 'other')"));
    const auto node = database_.number("SELECT id FROM scanloom.node WHERE name = 'a'");
    auto connection = test::connect(database_.address);
    const auto take = [&](bool is_steady) { return postgres::take(connection, session, {node, is_steady}); };
    EXPECT_THAT(take(true).error().message, HasSubstr("belongs to node other;"));
    static_cast<void>(database_.run("UPDATE scanloom.node SET seen = now() - interval '6 s' WHERE name = 'other'"));
    EXPECT_THAT(take(false).error().message, HasSubstr("node other, which does not answer")) << "perhaps no node could";
    EXPECT_TRUE(take(true));
}

TEST_F(PostgresOwnershipTest, ALaterServerOfTheSameNameHasTheSessionsAtOnce) {
    const auto earlier = open("a");
    const auto session = earlier->create_session("").value();
    ASSERT_TRUE(append_and_wait(*earlier, session, 1, {"before"}));
    const auto later = open("a");
    ASSERT_TRUE(own(*later, session));
    EXPECT_TRUE(append_and_wait(*later, session, 2, {"after"}));
    EXPECT_EQ(append_and_wait(*earlier, session, 2, {"late"}).error().code, Errc::kNotOwner);
    while (!earlier->stats().last_error) std::this_thread::yield(); // until it looks at its row
    EXPECT_THAT(*earlier->stats().last_error, HasSubstr("this server is not node 'a'"));
    EXPECT_EQ(earlier->shared()->own(session).error().code, Errc::kNotOwner) << "robots try another server";
    EXPECT_EQ(earlier->create_session("").error().code, Errc::kNotOwner);
    EXPECT_FALSE(earlier->reopen());
    EXPECT_THAT(*earlier->stats().last_error, HasSubstr("give each server a --node of its own"));
    EXPECT_THAT(entries_after(*later, session, 0).value(), ElementsAre("before", "after"));
}

TEST_F(PostgresOwnershipTest, ALogThatIsOpenedAgainKeepsItsSessionsButNotThoseThatOthersHaveTaken) {
    const auto a = open("a");
    const auto kept = a->create_session("").value();
    const auto lost = a->create_session("").value();
    ASSERT_TRUE(append_and_wait(*a, kept, 1, {"kept"}));
    static_cast<void>(
        database_.run("UPDATE scanloom.session SET epoch = epoch + 1, owner = 0 WHERE id = " + std::to_string(lost)));
    database_.fail_next_insertion();
    ASSERT_EQ(append_and_wait(*a, kept, 2, {"x"}).error().code, Errc::kStoreFailed);
    ASSERT_TRUE(a->reopen());
    EXPECT_TRUE(append_and_wait(*a, kept, 2, {"next"}));
    EXPECT_EQ(append_and_wait(*a, lost, 1, {"late"}).error().code, Errc::kNotOwner);
}

TEST_F(PostgresOwnershipTest, NamesAreUniqueOnAllServers) {
    const auto a = open("a");
    const auto b = open("b");
    const auto session = a->create_session(record_of("s")).value();
    const auto second = b->create_session(record_of("s"));
    EXPECT_EQ(second.error().code, Errc::kAlreadyExists);
    EXPECT_THAT(second.error().message, HasSubstr("session 's' exists already"));
    EXPECT_EQ(b->shared()->find("s").value().value().stored.id, session);
    EXPECT_THAT(b->shared()->list().value().sessions, ElementsAre(Key(session)));
    ASSERT_TRUE(a->remove_session(session));
    EXPECT_FALSE(b->shared()->find("s").value());
    EXPECT_TRUE(b->create_session(record_of("s")));
}

TEST_F(PostgresOwnershipTest, ACopyHasTheNameWhenTheSessionThatItReplacesIsRemoved) {
    const auto a = open("a");
    const auto session = a->create_session(record_of("s")).value();
    const auto copy = a->create_session(record_of("s", session)).value();
    EXPECT_EQ(a->shared()->find("s").value().value().stored.id, session);
    EXPECT_THAT(a->shared()->list().value().sessions, ElementsAre(Key(session)));
    EXPECT_THAT(a->sessions().value(), SizeIs(2));
    ASSERT_TRUE(a->remove_session(session));
    EXPECT_EQ(a->shared()->find("s").value().value().stored.id, copy);
    EXPECT_EQ(a->create_session(record_of("s")).error().code, Errc::kAlreadyExists);
}

TEST_F(PostgresOwnershipTest, ACopyThatHasReplacedItsSessionIsASessionLikeOthers) {
    const auto a = open("a");
    const auto copy = a->create_session(record_of("s", 99)).value(); // of another store
    EXPECT_EQ(a->shared()->find("s").value().value().stored.id, copy);
}

TEST_F(PostgresOwnershipTest, ACopyBelongsToTheServerThatHasTheSessionThatItIsToReplace) {
    const auto a = open("a");
    const auto b = open("b");
    const auto session = a->create_session(record_of("s")).value();
    const auto copy = a->create_session(record_of("s", session)).value();
    EXPECT_EQ(own(*b, copy).error().code, Errc::kNotOwner);
    ASSERT_TRUE(a->shared()->disown(session));
    ASSERT_TRUE(own(*b, session));
    ASSERT_TRUE(own(*b, copy));
    EXPECT_TRUE(b->remove_session(copy));
}

TEST_F(PostgresOwnershipTest, ASessionThatWasLostIsTakenAgainWithWhatOthersWrote) {
    const auto a = open("a");
    const auto session = a->create_session("").value();
    const auto transaction = [&] { return database_.number("SELECT xmin::text::bigint FROM scanloom.session"); };
    const auto before = transaction();
    EXPECT_TRUE(a->shared()->confirm(session));
    EXPECT_NE(transaction(), before) << "by a commit";
    static_cast<void>(database_.run("UPDATE scanloom.session SET owner = 0"));
    {
        const auto b = open("b");
        ASSERT_TRUE(own(*b, session));
        ASSERT_TRUE(append_and_wait(*b, session, 1, {"of b"}));
    }
    EXPECT_EQ(a->shared()->confirm(session).error().code, Errc::kNotOwner);
    ASSERT_TRUE(own(*a, session));
    EXPECT_THAT(entries_after(*a, session, 0).value(), ElementsAre("of b"));
    EXPECT_TRUE(append_and_wait(*a, session, 2, {"of a"}));
}

TEST_F(PostgresOwnershipTest, AStoreOfFormat1GetsNamesAndLosesItsOwners) {
    SessionId session = 0;
    SessionId copy = 0;
    {
        const auto log = open("a");
        session = log->create_session(record_of("s")).value();
        copy = log->create_session(record_of("s", session)).value();
        ASSERT_TRUE(log->create_session(record_of("t", 99)));
        ASSERT_TRUE(append_and_wait(*log, session, 1, {"a"}));
    }
    for (const char* statement :
         {"DROP TABLE scanloom.node", "ALTER TABLE scanloom.session DROP COLUMN name, DROP COLUMN replaces",
          "CREATE SEQUENCE scanloom.owner", "UPDATE scanloom.session SET owner = 1",
          "DELETE FROM scanloom.meta WHERE key = 'secret'",
          "UPDATE scanloom.meta SET value = '1' WHERE key = 'format'"}) {
        static_cast<void>(database_.run(statement));
    }
    EXPECT_THAT(open_postgres_read_only(database_.address).value().log->sessions().value(), SizeIs(3));
    const auto log = open("a");
    EXPECT_TRUE(log->shared()->find("t").value());
    EXPECT_EQ(log->shared()->find("s").value().value().stored.id, session);
    ASSERT_TRUE(own(*log, session));
    EXPECT_TRUE(append_and_wait(*log, session, 2, {"b"}));
    ASSERT_TRUE(log->remove_session(session));
    EXPECT_EQ(log->shared()->find("s").value().value().stored.id, copy);
}

TEST_F(PostgresOwnershipTest, TwoServersThatRaceForASessionWriteOneLog) {
    race_for_sessions(*open("a"), *open("b"), 25); // 1,000 in nightly_test
}

} // namespace
} // namespace scanloom::store
