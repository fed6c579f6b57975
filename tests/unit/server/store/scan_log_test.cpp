#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/store/postgres_database.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

/// The contract of ScanLog. A new implementation needs a backend here.
namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

/// One implementation: a log, and a way to let its next write fail.
struct Memory {
    MemoryScanLog log;
    ScanLog& get() { return log; }
    void fail_next_write() { log.fail_from_next_change({Errc::kStoreFailed, "the disk failed"}); }
};

struct Rocksdb {
    TemporaryDirectory directory;
    FaultyEnv disk;
    std::unique_ptr<ScanLog> log = open_rocksdb(directory.path(), {.env = disk.env.get()}).value();
    ScanLog& get() { return *log; }
    void fail_next_write() { disk.files->fail_next_log_sync(); }
};

struct Postgres {
    PostgresDatabase database;
    std::unique_ptr<ScanLog> log = open_postgres(database.address, {.allow_unreplicated = true}).value();
    ScanLog& get() { return *log; }
    void fail_next_write() { database.fail_next_insertion(); }
};

template <class Backend>
class ScanLogContract : public testing::Test {
protected:
    Backend backend_;
    ScanLog& log_ = backend_.get();
};

using Backends = testing::Types<Memory, Rocksdb, Postgres>;
TYPED_TEST_SUITE(ScanLogContract, Backends);

TYPED_TEST(ScanLogContract, AFreshLogHasNoSessions) { EXPECT_THAT(this->log_.sessions().value(), IsEmpty()); }

TYPED_TEST(ScanLogContract, ListsSessionsByAscendingIdWithTheirRecords) {
    const std::string binary("\0\xff\n", 3);
    const auto first = this->log_.create_session("one").value();
    const auto second = this->log_.create_session(binary).value();
    EXPECT_LT(first, second);
    const auto sessions = this->log_.sessions().value();
    ASSERT_THAT(sessions, SizeIs(2));
    EXPECT_EQ(sessions[0].id, first);
    EXPECT_EQ(sessions[0].record.value(), "one");
    EXPECT_EQ(sessions[1].id, second);
    EXPECT_EQ(sessions[1].record.value(), binary);
}

TYPED_TEST(ScanLogContract, IdsAreNotReusedAfterRemoval) {
    const auto first = this->log_.create_session("one").value();
    ASSERT_TRUE(this->log_.remove_session(first));
    EXPECT_GT(this->log_.create_session("two").value(), first);
}

TYPED_TEST(ScanLogContract, ReadsEntriesInOrderFromAnyRevision) {
    const auto session = this->log_.create_session("s").value();
    const auto other = this->log_.create_session("o").value();
    const auto written = distinct_entries(session, 1, 700); // more revisions than fit into one byte
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {written.begin(), written.begin() + 300}));
    ASSERT_TRUE(append_and_wait(this->log_, other, 1, {"other"}));
    ASSERT_TRUE(append_and_wait(this->log_, session, 301, {written.begin() + 300, written.end()}));
    for (const Revision after : {0, 1, 255, 256, 299, 300, 301, 699, 700}) {
        const auto begin = written.begin() + static_cast<std::ptrdiff_t>(after);
        EXPECT_EQ(entries_after(this->log_, session, after).value(), std::vector<std::string>(begin, written.end()))
            << "after " << after;
    }
    EXPECT_THAT(entries_after(this->log_, other, 0).value(), ElementsAre("other"));
}

TYPED_TEST(ScanLogContract, RevisionsAreCountedFromOne) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a", "b", "c"}));
    std::vector<Revision> revisions;
    ASSERT_TRUE(this->log_.read(session, 1, [&](Revision revision, std::string_view) -> Result<> {
        revisions.push_back(revision);
        return {};
    }));
    EXPECT_THAT(revisions, ElementsAre(2, 3));
}

TYPED_TEST(ScanLogContract, KeepsEmptyAndBinaryEntries) {
    const auto session = this->log_.create_session("").value();
    const std::string binary("\0\0\xff\x80", 4);
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"", binary}));
    EXPECT_THAT(entries_after(this->log_, session, 0).value(), ElementsAre("", binary));
}

TYPED_TEST(ScanLogContract, AnAppendThatDoesNotContinueTheLogIsRefusedAndChangesNothing) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a", "b"}));
    for (const Revision first : {0, 1, 2, 4}) {
        const auto appended = append_and_wait(this->log_, session, first, {"x"});
        ASSERT_FALSE(appended) << first;
        EXPECT_EQ(appended.error().code, Errc::kConflict);
        EXPECT_THAT(appended.error().message, HasSubstr("ends with 2"));
    }
    EXPECT_THAT(entries_after(this->log_, session, 0).value(), ElementsAre("a", "b"));
    EXPECT_TRUE(append_and_wait(this->log_, session, 3, {"c"})) << "a refused append is not a failure of the store";
}

TYPED_TEST(ScanLogContract, ReadingStopsAtTheVisitorsError) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a", "b", "c"}));
    int visits = 0;
    const auto read = this->log_.read(session, 0, [&](Revision revision, std::string_view) -> Result<> {
        ++visits;
        if (revision == 2) return Error{Errc::kMalformed, "mine"};
        return {};
    });
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error(), (Error{Errc::kMalformed, "mine"}));
    EXPECT_EQ(visits, 2);
}

TYPED_TEST(ScanLogContract, ReadingBeyondTheEndOfTheLogIsAnError) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a", "b"}));
    const auto entries = entries_after(this->log_, session, 3);
    ASSERT_FALSE(entries);
    EXPECT_EQ(entries.error().code, Errc::kDataLoss);
    EXPECT_THAT(entries.error().message, HasSubstr("ends before revision 3"));
}

TYPED_TEST(ScanLogContract, UnnamedPartsOfACheckpointStay) {
    const auto session = this->log_.create_session("s").value();
    const auto other = this->log_.create_session("o").value();
    EXPECT_THAT(checkpoint_of(this->log_, session).value(), IsEmpty());
    ASSERT_TRUE(this->log_.write_checkpoint(session, {{"b", "1"}, {"a", "1"}, {"", "empty"}}));
    ASSERT_TRUE(this->log_.write_checkpoint(session, {{"b", "2"}, {std::string("\0", 1), ""}}));
    ASSERT_TRUE(this->log_.write_checkpoint(other, {{"a", "other"}}));
    EXPECT_THAT(checkpoint_of(this->log_, session).value(),
                ElementsAre(Pair("", "empty"), Pair(std::string("\0", 1), ""), Pair("a", "1"), Pair("b", "2")));
}

TYPED_TEST(ScanLogContract, RemovingASessionKeepsItsNeighbours) {
    std::vector<SessionId> sessions;
    for (const auto* record : {"a", "b", "c"}) {
        sessions.push_back(this->log_.create_session(record).value());
        ASSERT_TRUE(append_and_wait(this->log_, sessions.back(), 1, {record}));
        ASSERT_TRUE(this->log_.write_checkpoint(sessions.back(), {{record, record}}));
    }
    const SessionId removed = sessions[1];
    ASSERT_TRUE(this->log_.remove_session(removed));

    EXPECT_EQ(this->log_.remove_session(removed).error().code, Errc::kNotFound);
    EXPECT_EQ(append_and_wait(this->log_, removed, 2, {"x"}).error().code, Errc::kNotFound);
    EXPECT_EQ(this->log_.write_checkpoint(removed, {}).error().code, Errc::kNotFound);
    EXPECT_EQ(entries_after(this->log_, removed, 0).error().code, Errc::kNotFound);
    EXPECT_EQ(checkpoint_of(this->log_, removed).error().code, Errc::kNotFound);
    for (const auto& stored : this->log_.sessions().value()) {
        EXPECT_NE(stored.id, removed);
        const auto& record = stored.record.value();
        EXPECT_THAT(entries_after(this->log_, stored.id, 0).value(), ElementsAre(record));
        EXPECT_THAT(checkpoint_of(this->log_, stored.id).value(), ElementsAre(Pair(record, record)));
    }
}

TYPED_TEST(ScanLogContract, AClearedCheckpointCanBeWrittenAgain) {
    const auto session = this->log_.create_session("s").value();
    const auto other = this->log_.create_session("t").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"entry"}));
    for (const auto id : {session, other}) ASSERT_TRUE(this->log_.write_checkpoint(id, {{"a", "1"}, {"b", "2"}}));
    ASSERT_TRUE(this->log_.clear_checkpoint(session));
    EXPECT_THAT(checkpoint_of(this->log_, session).value(), IsEmpty());
    EXPECT_THAT(checkpoint_of(this->log_, other).value(), SizeIs(2));
    EXPECT_THAT(entries_after(this->log_, session, 0).value(), ElementsAre("entry"));
    ASSERT_TRUE(this->log_.write_checkpoint(session, {{"c", "3"}}));
    EXPECT_THAT(checkpoint_of(this->log_, session).value(), ElementsAre(Pair("c", "3")));
    EXPECT_EQ(this->log_.clear_checkpoint(99).error().code, Errc::kNotFound);
}

TYPED_TEST(ScanLogContract, ThreadsAppendToTheirSessionsConcurrently) {
    constexpr std::size_t kThreads = 8;
    constexpr Revision kAppends = 200;
    std::vector<SessionId> sessions;
    for (std::size_t i = 0; i < kThreads; ++i) sessions.push_back(this->log_.create_session("s").value());
    std::atomic<std::uint64_t> done = 0;
    const auto before = this->log_.stats();
    {
        std::vector<std::jthread> threads;
        for (const SessionId session : sessions) {
            threads.emplace_back([&, session] {
                for (Revision revision = 1; revision < kAppends; ++revision) {
                    this->log_.append(session, revision, distinct_entries(session, revision, 1),
                                      [&](Result<> result) { done += result ? 1 : 0; });
                }
                done += append_and_wait(this->log_, session, kAppends, distinct_entries(session, kAppends, 1)) ? 1 : 0;
            });
        }
    }
    EXPECT_EQ(done, kThreads * kAppends) << "each callback is called once, the earlier ones before the last";
    for (const SessionId session : sessions) {
        EXPECT_EQ(entries_after(this->log_, session, 0).value(), distinct_entries(session, 1, kAppends));
    }
    EXPECT_EQ(this->log_.stats().appends - before.appends, kThreads * kAppends);
    EXPECT_EQ(this->log_.stats().entries - before.entries, kThreads * kAppends);
}

TYPED_TEST(ScanLogContract, AnEmptyAppendSucceeds) {
    const auto session = this->log_.create_session("s").value();
    EXPECT_TRUE(append_and_wait(this->log_, session, 1, {}));
    EXPECT_TRUE(append_and_wait(this->log_, session, 1, {"a"}));
}

TYPED_TEST(ScanLogContract, AVisitorMayAppend) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a"}));
    ASSERT_TRUE(this->log_.read(session, 0, [&](Revision, std::string_view) -> Result<> {
        return append_and_wait(this->log_, session, 2, {"b"});
    }));
    EXPECT_THAT(entries_after(this->log_, session, 0).value(), ElementsAre("a", "b"));
}

TYPED_TEST(ScanLogContract, TheEndOfALogIsItsLastRevision) {
    const auto session = this->log_.create_session("s").value();
    EXPECT_EQ(this->log_.end_of(session).value(), 0U);
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a", "b"}));
    ASSERT_TRUE(append_and_wait(this->log_, session, 3, {"c"}));
    EXPECT_EQ(this->log_.end_of(session).value(), 3U);
    EXPECT_EQ(this->log_.end_of(99).error().code, Errc::kNotFound);
}

TYPED_TEST(ScanLogContract, AFailedLogAcceptsNoChangeUntilItIsReopened) {
    const auto session = this->log_.create_session("s").value();
    ASSERT_TRUE(append_and_wait(this->log_, session, 1, {"a"}));
    EXPECT_FALSE(this->log_.reopen()) << "it has not failed";
    this->backend_.fail_next_write();
    for (int attempt = 0; attempt < 2; ++attempt) {
        EXPECT_EQ(append_and_wait(this->log_, session, 2, {"b"}).error().code, Errc::kStoreFailed);
    }
    EXPECT_EQ(this->log_.create_session("t").error().code, Errc::kStoreFailed);
    EXPECT_EQ(this->log_.write_checkpoint(session, {{"k", "v"}}).error().code, Errc::kStoreFailed);
    EXPECT_EQ(this->log_.clear_checkpoint(session).error().code, Errc::kStoreFailed);
    EXPECT_EQ(this->log_.remove_session(session).error().code, Errc::kStoreFailed);
    EXPECT_TRUE(this->log_.stats().last_error);
    EXPECT_THAT(entries_after(this->log_, session, 0).value(), ElementsAre("a")) << "reading continues";

    ASSERT_TRUE(this->log_.reopen());
    EXPECT_FALSE(this->log_.stats().last_error);
    const auto end = this->log_.end_of(session).value();
    EXPECT_GE(end, 1U) << "the failed append may have been stored";
    EXPECT_TRUE(append_and_wait(this->log_, session, end + 1, {"c"}));
}

TYPED_TEST(ScanLogContract, ALogHasAnIdentityIfItHasBackups) {
    const TemporaryDirectory place;
    const auto backup = this->log_.backup_to(place.path() / "backups", {});
    EXPECT_EQ(this->log_.identity().has_value(), backup.has_value());
    if (!backup) {
        EXPECT_EQ(backup.error().code, Errc::kInvalidField);
    }
}

TEST(MemoryScanLog, AFailureLastsUntilReopenAndReadingContinues) {
    MemoryScanLog log;
    const auto session = log.create_session("s").value();
    ASSERT_TRUE(append_and_wait(log, session, 1, {"a"}));
    log.fail_from_next_change({Errc::kStoreFailed, "disk gone"});
    EXPECT_EQ(append_and_wait(log, session, 2, {"b"}).error().message, "disk gone");
    EXPECT_EQ(append_and_wait(log, session, 2, {"b"}).error().message, "disk gone");
    EXPECT_FALSE(log.write_checkpoint(session, {}));
    EXPECT_EQ(log.stats().last_error, "disk gone");
    EXPECT_THAT(entries_after(log, session, 0).value(), ElementsAre("a"));
    log.reopen();
    EXPECT_TRUE(append_and_wait(log, session, 2, {"b"}));
}

TEST(MemoryScanLog, HeldCompletionsComeInOrderWhenReleased) {
    MemoryScanLog log;
    const auto session = log.create_session("s").value();
    std::vector<int> done;
    log.hold_completions();
    log.append(session, 1, {"a"}, [&](Result<> result) { done.push_back(result ? 1 : -1); });
    log.append(session, 2, {"b"}, [&](Result<> result) { done.push_back(result ? 2 : -2); });
    EXPECT_THAT(done, IsEmpty());
    EXPECT_EQ(log.held_completions(), 2U);
    EXPECT_EQ(log.stats().queued_bytes, 2U);
    EXPECT_THAT(entries_after(log, session, 0).value(), IsEmpty());
    log.release_completions();
    EXPECT_THAT(done, ElementsAre(1, 2));
    EXPECT_THAT(entries_after(log, session, 0).value(), ElementsAre("a", "b"));
}

TEST(MemoryScanLog, HeldCompletionsAreCalledByTheDestructor) {
    int done = 0;
    {
        MemoryScanLog log;
        const auto session = log.create_session("s").value();
        log.hold_completions();
        log.append(session, 1, {"a"}, [&](Result<>) { ++done; });
    }
    EXPECT_EQ(done, 1);
}

} // namespace
} // namespace scanloom::store
