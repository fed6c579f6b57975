#include "server/store/backups.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>
#include <rocksdb/utilities/backup_engine.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include <sys/stat.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::uint64_t bytes_below(const fs::path& directory) {
    std::uint64_t bytes = 0;
    for (const auto& file : fs::recursive_directory_iterator(directory)) {
        if (file.is_regular_file()) bytes += file.file_size();
    }
    return bytes;
}

class BackupsTest : public testing::Test {
protected:
    void append(Revision first, std::size_t count) {
        append_and_wait(*log_, session_, first, distinct_entries(session_, first, count)).value();
    }

    [[nodiscard]] fs::path at(const char* name) const { return directory_.path() / name; }

    /// Returns the entries of a restored store.
    [[nodiscard]] std::vector<std::string> entries_of(const fs::path& store) const {
        const auto log = open_rocksdb(store).value();
        return entries_after(*log, session_, 0).value();
    }

    TemporaryDirectory directory_;
    std::unique_ptr<ScanLog> log_ = open_rocksdb(at("store")).value();
    SessionId session_ = log_->create_session("a session").value();
    std::vector<std::string> reported_;
    std::unique_ptr<Backups> backups_ =
        Backups::open(at("backups"), 3, *log_, [this](const std::string& what) { reported_.push_back(what); }).value();
};

TEST_F(BackupsTest, EachRestoresTheStoreAtItsTime) {
    append(1, 100);
    const auto first = backups_->make(*log_).value();
    append(101, 50);
    const auto second = backups_->make(*log_).value();
    append(151, 10);
    EXPECT_EQ(first.sessions, 1U);
    EXPECT_GT(first.time, 1.7e9);
    EXPECT_LT(first.id, second.id);
    EXPECT_EQ(backups_->list().value(), (std::vector<Backup>{first, second}));

    EXPECT_EQ(restore_backup(at("backups"), first.id, at("one")).value(), first);
    EXPECT_EQ(entries_of(at("one")), distinct_entries(session_, 1, 100));
    EXPECT_EQ(restore_backup(at("backups"), {}, at("two")).value(), second);
    EXPECT_EQ(entries_of(at("two")), distinct_entries(session_, 1, 150));
}

TEST_F(BackupsTest, TablesAreCopiedOnce) {
    append(1, 1000);
    static_cast<void>(backups_->make(*log_).value());
    const auto before = bytes_below(at("backups"));
    append(1001, 1);
    const auto second = backups_->make(*log_).value();
    EXPECT_LT(bytes_below(at("backups")) - before, before / 10);
    EXPECT_GT(second.bytes, before * 9 / 10) << "the size of the whole store";
}

TEST_F(BackupsTest, OnlyTheNewestAreKept) {
    for (Revision revision = 1; revision <= 5; ++revision) {
        append(revision, 1);
        static_cast<void>(backups_->make(*log_).value());
    }
    EXPECT_THAT(backups_->list().value(), SizeIs(3));
    EXPECT_EQ(backups_->list().value().front().id, 3U);
    EXPECT_THAT(restore_backup(at("backups"), 1, at("one")).error().message, HasSubstr("there are 3 to 5"));
    backups_.reset();
    EXPECT_THAT(Backups::open(at("backups"), 3, *log_).value()->list().value(), SizeIs(3)) << "also after a restart";
}

TEST_F(BackupsTest, ABackupOfAnIdleStoreRestores) {
    append(1, 3);
    static_cast<void>(backups_->make(*log_).value());
    static_cast<void>(backups_->make(*log_).value());
    ASSERT_TRUE(restore_backup(at("backups"), {}, at("one")));
    EXPECT_EQ(entries_of(at("one")), distinct_entries(session_, 1, 3));
}

TEST_F(BackupsTest, ABackupDuringAppendsHasAllEarlierEntriesOnce) {
    append(1, 100);
    std::atomic<bool> stop = false;
    Revision end = 100;
    std::thread robot([&] {
        while (!stop) {
            append(end + 1, 20);
            end += 20;
        }
    });
    const auto made = backups_->make(*log_);
    stop = true;
    robot.join();
    ASSERT_TRUE(made) << made.error().message;
    ASSERT_TRUE(restore_backup(at("backups"), {}, at("one")));
    const auto restored = entries_of(at("one"));
    EXPECT_GE(restored.size(), 100U);
    EXPECT_EQ(restored, distinct_entries(session_, 1, restored.size()));
}

TEST_F(BackupsTest, ADamagedBackupIsNotRestored) {
    append(1, 100);
    static_cast<void>(backups_->make(*log_).value());
    const auto table = only_file_like(at("backups") / "shared_checksum", ".sst");
    flip_bit(table, fs::file_size(table) / 2, 1);
    EXPECT_EQ(restore_backup(at("backups"), {}, at("one")).error().code, Errc::kStoreFailed);
}

TEST_F(BackupsTest, TwoServersCannotUseOneDirectory) {
    append(1, 3);
    const auto made = backups_->make(*log_).value();
    EXPECT_EQ(Backups::open(at("backups"), 3, *log_).error(),
              (Error{Errc::kConflict, fmt::format("the directory of backups {} is in use by another scanloom-server; "
                                                  "name another directory",
                                                  at("backups").native())}));
    EXPECT_EQ(restore_backup(at("backups"), {}, at("one")).value(), made) << "restoring needs no lock";
    backups_.reset();
    EXPECT_TRUE(Backups::open(at("backups"), 3, *log_));
}

TEST_F(BackupsTest, NothingIsOverwritten) {
    static_cast<void>(backups_->make(*log_).value());
    fs::create_directory(at("mine"));
    write_bytes(at("mine") / "file", "mine");
    EXPECT_EQ(restore_backup(at("backups"), {}, at("mine")).error().code, Errc::kConflict);
    EXPECT_EQ(bytes_of(at("mine") / "file"), "mine");
    EXPECT_EQ(restore_backup(at("backups"), {}, at("store")).error().code, Errc::kConflict);
}

TEST_F(BackupsTest, ReportsThatThereIsNoBackup) {
    EXPECT_THAT(restore_backup(at("backups"), {}, at("one")).error().message, HasSubstr("there is no backup"));
    EXPECT_EQ(restore_backup(at("nowhere"), {}, at("one")).error().code, Errc::kNotFound);
    EXPECT_FALSE(fs::exists(at("nowhere")));
    EXPECT_FALSE(fs::exists(at("one")));
}

TEST_F(BackupsTest, RefusesADirectoryWithBackupsOfAnotherStore) {
    static_cast<void>(backups_->make(*log_).value());
    const auto other = open_rocksdb(at("other")).value();
    EXPECT_EQ(backups_->make(*other).error().code, Errc::kConflict);
    backups_.reset();
    const auto refused = Backups::open(at("backups"), 3, *other);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kConflict);
    EXPECT_THAT(refused.error().message, HasSubstr("has backups of another store (backup 1)"));
    EXPECT_THAT(Backups::open(at("backups"), 3, *log_).value()->list().value(), SizeIs(1))
        << "backups of its own store stay";
}

TEST_F(BackupsTest, ARestoredStoreMayUseTheSameDirectory) {
    append(1, 10);
    static_cast<void>(backups_->make(*log_).value());
    backups_.reset();
    log_.reset();
    ASSERT_TRUE(restore_backup(at("backups"), {}, at("one")));
    for (int turn = 0; turn < 2; ++turn) { // also after a restart
        const auto restored = open_rocksdb(at("one")).value();
        const auto opened = Backups::open(at("backups"), 9, *restored);
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_TRUE((*opened)->make(*restored));
    }
}

TEST_F(BackupsTest, BackupsWithoutTheStoresIdentityStayUsable) {
    backups_.reset();
    log_.reset();
    {
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open({}, at("store").native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        rocksdb::BackupEngine* opened_engine = nullptr;
        const rocksdb::BackupEngineOptions options(at("backups").native());
        ASSERT_TRUE(rocksdb::BackupEngine::Open(rocksdb::Env::Default(), options, &opened_engine).ok());
        const std::unique_ptr<rocksdb::BackupEngine> engine(opened_engine);
        ASSERT_TRUE(engine->CreateNewBackupWithMetadata(database.get(), "1", true).ok()); // as earlier versions did
    }
    log_ = open_rocksdb(at("store")).value();
    const auto backups = Backups::open(at("backups"), 3, *log_).value();
    ASSERT_THAT(backups->list().value(), SizeIs(1));
    EXPECT_EQ(backups->list().value().front().sessions, 1U);
    EXPECT_TRUE(backups->make(*log_));
    EXPECT_TRUE(restore_backup(at("backups"), 1, at("one")));
}

TEST_F(BackupsTest, ARemovedOrEmptiedDirectoryIsCreatedAgain) {
    append(1, 10);
    for (const bool whole : {false, true}) {
        static_cast<void>(backups_->make(*log_).value());
        const auto before = backups_->list().value();
        ASSERT_THAT(before, SizeIs(1));
        for (const auto& file : fs::directory_iterator(at("backups"))) fs::remove_all(file.path());
        if (whole) fs::remove(at("backups"));
        reported_.clear();
        EXPECT_THAT(backups_->list().value(), IsEmpty());
        EXPECT_THAT(backups_->list().value(), IsEmpty());
        EXPECT_THAT(reported_, testing::ElementsAre(HasSubstr("has lost the backups 1: ")));
        ASSERT_TRUE(backups_->make(*log_));
        EXPECT_THAT(reported_, SizeIs(1)) << "each loss is reported once";
        EXPECT_EQ(Backups::open(at("backups"), 3, *log_).error().code, Errc::kConflict) << "the lock is taken again";
        fs::remove_all(at("one"));
        ASSERT_TRUE(restore_backup(at("backups"), {}, at("one")));
        EXPECT_EQ(entries_of(at("one")), distinct_entries(session_, 1, 10));
        fs::remove_all(at("backups"));
        EXPECT_THAT(backups_->list().value(), IsEmpty());
    }
}

TEST_F(BackupsTest, MakesNoneOnAnotherDisk) {
    std::string elsewhere = "/dev/shm/scanloom-test-XXXXXX";
    if (::mkdtemp(elsewhere.data()) == nullptr)
        GTEST_SKIP() << "/dev/shm is not a second file system next to that of temporary files";
    struct stat here = {};
    struct stat there = {};
    ASSERT_EQ(::stat(directory_.path().c_str(), &here), 0);
    ASSERT_EQ(::stat(elsewhere.c_str(), &there), 0);
    if (here.st_dev == there.st_dev) {
        fs::remove_all(elsewhere);
        GTEST_SKIP() << "/dev/shm is not a second file system next to that of temporary files";
    }
    fs::create_directory_symlink(at("backups"), at("mounted"));
    backups_.reset();
    backups_ = Backups::open(at("mounted"), 3, *log_).value();
    static_cast<void>(backups_->make(*log_).value());
    const auto mount = [&](const fs::path& disk) {
        fs::remove(at("mounted"));
        fs::create_directory_symlink(disk, at("mounted"));
    };
    mount(elsewhere);
    for (const auto& error : {backups_->make(*log_).error(), backups_->list().error()}) {
        EXPECT_EQ(error.code, Errc::kStoreFailed);
        EXPECT_THAT(error.message, HasSubstr("is on another disk than when the server started"));
    }
    EXPECT_TRUE(fs::is_empty(elsewhere));
    fs::remove_all(elsewhere);
    mount(at("backups"));
    EXPECT_THAT(backups_->list().value(), SizeIs(1));
    EXPECT_TRUE(backups_->make(*log_));
}

/// Requests a backup while one is being made of it.
class AskingAgain final : public MemoryScanLog {
public:
    explicit AskingAgain(Backups& backups) : backups_(backups) {}
    Result<> backup_to(const fs::path&, const std::stop_token&) override {
        std::thread([this] { answer_ = backups_.make(*this).error(); }).join();
        return answer_;
    }

private:
    Backups& backups_;
    Error answer_{};
};

TEST_F(BackupsTest, RefusesASecondBackupAtTheSameTime) {
    AskingAgain log(*backups_);
    EXPECT_EQ(backups_->make(log).error().code, Errc::kConflict);
}

TEST_F(BackupsTest, RefusesALogWithoutBackups) {
    MemoryScanLog log;
    EXPECT_EQ(backups_->make(log).error().code, Errc::kInvalidField);
    EXPECT_THAT(backups_->list().value(), IsEmpty());
}

TEST_F(BackupsTest, MakesNoneOnceStopped) {
    append(1, 3);
    backups_->stop();
    EXPECT_EQ(backups_->make(*log_).error().code, Errc::kShuttingDown);
    EXPECT_THAT(backups_->list().value(), IsEmpty());
}

} // namespace
} // namespace scanloom::store
