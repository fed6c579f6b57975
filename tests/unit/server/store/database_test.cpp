#include "server/store/directory.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>

#include <random>
#include <thread>

/// Opening new and existing stores, and directories that cannot be stores.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

std::string problem_of(const fs::path& directory) {
    const auto log = open_rocksdb(directory);
    return log ? "" : log.error().message;
}

/// Changes keys of a store without ScanLog.
void write_raw(const fs::path& directory, const std::function<rocksdb::Status(rocksdb::DB&)>& change) {
    rocksdb::Options options;
    options.create_if_missing = true;
    rocksdb::DB* opened = nullptr;
    ASSERT_TRUE(rocksdb::DB::Open(options, directory.native(), &opened).ok());
    const std::unique_ptr<rocksdb::DB> database(opened);
    ASSERT_TRUE(change(*database).ok());
}

class OpenRocksdb : public testing::Test {
protected:
    TemporaryDirectory temporary_;
    fs::path directory_ = temporary_.path() / "new" / "store";
};

TEST_F(OpenRocksdb, KeepsEverythingWhenReopened) {
    SessionId session = 0;
    {
        auto log = open_rocksdb(directory_).value();
        session = log->create_session("record").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, distinct_entries(session, 1, 50)));
        ASSERT_TRUE(log->write_checkpoint(session, {{"k", "v"}}));
    }
    auto log = open_rocksdb(directory_).value();
    const auto sessions = log->sessions().value();
    ASSERT_THAT(sessions, SizeIs(1));
    EXPECT_EQ(sessions[0].id, session);
    EXPECT_EQ(sessions[0].record.value(), "record");
    EXPECT_EQ(entries_after(*log, session, 0).value(), distinct_entries(session, 1, 50));
    EXPECT_THAT(checkpoint_of(*log, session).value(), ElementsAre(Pair("k", "v")));
    EXPECT_EQ(append_and_wait(*log, session, 1, {"x"}).error().code, Errc::kConflict) << "the end of the log is known";
    EXPECT_TRUE(append_and_wait(*log, session, 51, {"x"}));
    EXPECT_EQ(log->stats().torn_bytes_dropped, 0U);
}

TEST_F(OpenRocksdb, IdsAreNotReusedAfterRemovalAndReopening) {
    const auto first = open_rocksdb(directory_).value()->create_session("a").value();
    ASSERT_TRUE(open_rocksdb(directory_).value()->remove_session(first));
    auto log = open_rocksdb(directory_).value();
    EXPECT_THAT(log->sessions().value(), IsEmpty());
    EXPECT_GT(log->create_session("b").value(), first);
}

TEST_F(OpenRocksdb, ClosingWritesQueuedAppends) {
    constexpr Revision kAppends = 500;
    auto log = open_rocksdb(directory_).value();
    const auto session = log->create_session("a").value();
    Revision done = 0;
    for (Revision revision = 1; revision <= kAppends; ++revision) {
        log->append(session, revision, distinct_entries(session, revision, 1),
                    [&](Result<> result) { done += result ? 1 : 0; });
    }
    log.reset();
    EXPECT_EQ(done, kAppends);
    EXPECT_EQ(entries_after(*open_rocksdb(directory_).value(), session, 0).value(),
              distinct_entries(session, 1, kAppends));
}

TEST_F(OpenRocksdb, ManyAppendsShareAnFsync) {
    constexpr Revision kAppends = 500;
    auto log = open_rocksdb(directory_).value();
    const auto session = log->create_session("a").value();
    for (Revision revision = 1; revision < kAppends; ++revision) log->append(session, revision, {"x"}, [](Result<>) {});
    ASSERT_TRUE(append_and_wait(*log, session, kAppends, {"x"}));
    EXPECT_LT(log->stats().synced_writes, kAppends / 2);
    EXPECT_EQ(log->stats().entries, kAppends);
    EXPECT_EQ(log->stats().queued_bytes, 0U);
}

TEST_F(OpenRocksdb, ARemovedSessionsDiskIsFreed) {
    StoreOptions options;
    options.memory_bytes = 2 << 20; // 256 KB of write buffer: tables soon
    auto log = open_rocksdb(directory_, options).value();
    const auto kept = log->create_session("kept").value();
    const auto removed = log->create_session("removed").value();
    ASSERT_TRUE(append_and_wait(*log, kept, 1, {"entry"}));
    std::mt19937_64 random(8);
    for (Revision revision = 1; revision <= 100; ++revision) {
        std::string entry(100'000, '\0'); // not compressible
        for (char& byte : entry) byte = static_cast<char>(random());
        ASSERT_TRUE(append_and_wait(*log, removed, revision, {std::move(entry)}));
    }
    const auto before = log->bytes_on_disk();
    EXPECT_GT(before, 10'000'000U);
    ASSERT_TRUE(log->remove_session(removed));
    while (log->bytes_on_disk() >= before / 4)
        std::this_thread::yield(); // tables that are being merged are deleted afterwards
    EXPECT_THAT(entries_after(*log, kept, 0).value(), ElementsAre("entry"));
}

TEST_F(OpenRocksdb, AStoreInUseIsRefused) {
    const auto log = open_rocksdb(directory_).value();
    EXPECT_THAT(problem_of(directory_),
                HasSubstr("the store " + directory_.native() + " is in use by another scanloom-server"));
}

TEST_F(OpenRocksdb, AnotherProgramsDatabaseIsRefused) {
    fs::create_directories(directory_);
    write_raw(directory_, [](rocksdb::DB& database) { return database.Put({}, "key", "value"); });
    EXPECT_THAT(problem_of(directory_), HasSubstr("without the format record of scanloom-server"));
}

TEST_F(OpenRocksdb, ADirectoryOfOtherFilesIsRefused) {
    fs::create_directories(directory_);
    write_bytes(directory_ / "holiday.jpg", "");
    EXPECT_THAT(problem_of(directory_), AllOf(HasSubstr("holiday.jpg"), HasSubstr("name a directory of its own")));
}

TEST_F(OpenRocksdb, AFileIsRefused) {
    write_bytes(temporary_.path() / "file", "");
    EXPECT_THAT(problem_of(temporary_.path() / "file"), HasSubstr("is not a directory"));
    EXPECT_THAT(problem_of(temporary_.path() / "file" / "below"), HasSubstr("cannot create the store"));
}

TEST_F(OpenRocksdb, ADirectoryThatCannotBeCreatedOrWrittenIsNamed) {
    // No user can create files in /proc, not even root.
    EXPECT_THAT(problem_of("/proc/scanloom"), HasSubstr("cannot create the store /proc/scanloom"));
    EXPECT_THAT(problem_of("/proc/self/fd"),
                HasSubstr("the store /proc/self/fd cannot be used: cannot write /proc/self/fd/scanloom.lock"));
}

TEST_F(OpenRocksdb, AMissingEntryIsReportedWithItsRevision) {
    SessionId session = 0;
    {
        auto log = open_rocksdb(directory_).value();
        session = log->create_session("a").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, {"1", "2", "3", "4"}));
    }
    write_raw(directory_, [&](rocksdb::DB& database) { return database.Delete({}, entry_key(session, 3)); });
    const auto entries = entries_after(*open_rocksdb(directory_).value(), session, 1);
    ASSERT_FALSE(entries);
    EXPECT_EQ(entries.error().code, Errc::kDataLoss);
    EXPECT_THAT(entries.error().message, HasSubstr("the entry of revision 3 is missing of session 1"));
}

TEST_F(OpenRocksdb, AnExchangedEntryIsReportedWithItsRevision) {
    SessionId session = 0;
    {
        auto log = open_rocksdb(directory_).value();
        session = log->create_session("a").value();
        ASSERT_TRUE(append_and_wait(*log, session, 1, {"1", "2", "3"}));
        ASSERT_TRUE(log->write_checkpoint(session, {{"a", "1"}}));
    }
    write_raw(directory_, [&](rocksdb::DB& database) {
        std::string value;
        auto status = database.Get({}, entry_key(session, 1), &value);
        if (status.ok()) status = database.Put({}, entry_key(session, 2), value);
        if (status.ok()) status = database.Put({}, part_key(session, "a"), value);
        return status;
    });
    auto log = open_rocksdb(directory_).value();
    EXPECT_THAT(entries_after(*log, session, 0).error().message, HasSubstr("revision 2 of session 1"));
    EXPECT_THAT(checkpoint_of(*log, session).error().message, HasSubstr("a part of the checkpoint of session 1"));
}

TEST_F(OpenRocksdb, ADamagedSessionAffectsNoOther) {
    const auto with_damaged_record = SessionId{1};
    const auto with_damaged_end = SessionId{2};
    {
        auto log = open_rocksdb(directory_).value();
        for (const auto session : {with_damaged_record, with_damaged_end}) {
            ASSERT_EQ(log->create_session("a").value(), session);
            ASSERT_TRUE(append_and_wait(*log, session, 1, {"entry"}));
        }
    }
    write_raw(directory_, [&](rocksdb::DB& database) {
        database.Put({}, session_key(with_damaged_record), "nonsense").PermitUncheckedError();
        return database.Put({}, entry_key(with_damaged_end, 1) + "too long", "");
    });
    auto log = open_rocksdb(directory_).value();
    const auto healthy = log->create_session("b").value();
    const auto sessions = log->sessions().value();
    ASSERT_THAT(sessions, SizeIs(3));
    EXPECT_THAT(sessions[0].record.error().message, HasSubstr("the record of session 1"));
    EXPECT_FALSE(sessions[0].damage);
    EXPECT_THAT(sessions[1].damage.value().message, HasSubstr("where the log of session 2 ends"));
    EXPECT_FALSE(sessions[2].damage);
    EXPECT_EQ(append_and_wait(*log, with_damaged_end, 1, {"entry"}).error(), *sessions[1].damage);
    EXPECT_TRUE(append_and_wait(*log, healthy, 1, {"entry"}));
    EXPECT_TRUE(log->remove_session(with_damaged_record));
    EXPECT_TRUE(log->remove_session(with_damaged_end));
}

TEST_F(OpenRocksdb, ADamagedRecordIsReported) {
    { ASSERT_TRUE(open_rocksdb(directory_).value()->create_session("a")); }
    write_raw(directory_, [&](rocksdb::DB& database) { return database.Put({}, session_key(1), "nonsense"); });
    EXPECT_THAT(open_rocksdb(directory_).value()->sessions().value().at(0).record.error().message,
                HasSubstr("the record of session 1"));
    write_raw(directory_,
              [&](rocksdb::DB& database) { return database.Put({}, std::string(kNextSessionKey), "nonsense"); });
    EXPECT_THAT(problem_of(directory_), HasSubstr("its record 'n' is damaged"));
}

TEST_F(OpenRocksdb, AStoreThatLostItsFilesIsNotReplacedByAnEmptyOne) {
    for (const auto* trace : {"IDENTITY", "MANIFEST-", "OPTIONS-"}) {
        static_cast<void>(open_rocksdb(directory_).value()->create_session("a").value());
        for (const auto& file : fs::directory_iterator(directory_)) {
            const auto name = file.path().filename().native();
            if (!name.starts_with(trace) && !name.starts_with("scanloom.")) fs::remove(file.path());
        }
        ASSERT_FALSE(fs::is_empty(directory_));
        EXPECT_THAT(problem_of(directory_), AllOf(HasSubstr("has lost all its entries"), HasSubstr(trace)));
        EXPECT_THAT(problem_of(directory_), HasSubstr("has lost all its entries")) << "at the second attempt, too";
        EXPECT_EQ(open_read_only(directory_).error().code, Errc::kStoreFailed);
        fs::remove_all(directory_);
    }
}

TEST_F(OpenRocksdb, AKilledFirstStartIsNotALostStore) {
    static_cast<void>(LockedDirectory::open(directory_).value()); // creates no store
    write_bytes(directory_ / "LOG", "");
    write_bytes(directory_ / "IDENTITY", "a-new-one");
    write_bytes(directory_ / "MANIFEST-000001", "");
    EXPECT_EQ(problem_of(directory_), "");
    fs::remove(directory_ / "CURRENT");
    EXPECT_NE(problem_of(directory_), "") << "it has been a store since";
}

} // namespace
} // namespace scanloom::store
