#include "server/store/directory.hpp"
#include "server/store/rocksdb_store.hpp"

#include "tests/support/faulty_file_system.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>

/// Stores whose files are deleted, moved or replaced while they are open.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

void remove_write_ahead_log(const fs::path& directory) { fs::remove(regular_files(directory, ".log").back()); }

void replace_by_a_copy(const fs::path& directory) {
    fs::rename(directory, directory.native() + ".away");
    fs::copy(directory.native() + ".away", directory, fs::copy_options::recursive);
}

std::set<std::string> names_in(const fs::path& directory) {
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(directory)) names.insert(file.path().filename());
    return names;
}

struct StoreDamage {
    std::string name;
    std::function<void(const fs::path&)> apply;
};

void PrintTo(const StoreDamage& damage, std::ostream* out) { *out << damage.name; }

class FilesWatchOf : public testing::TestWithParam<StoreDamage> {
protected:
    TemporaryDirectory temporary_;
    fs::path directory_ = temporary_.path() / "store";
};

TEST_P(FilesWatchOf, StopsAcknowledgingAndReportsTheLoss) {
    const auto log = open_rocksdb(directory_).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    ASSERT_FALSE(log->stats().last_error);
    GetParam().apply(directory_);
    const auto left = fs::exists(directory_) ? names_in(directory_) : std::set<std::string>();

    EXPECT_THAT(log->stats().last_error.value_or(""), HasSubstr("was deleted, moved or replaced"));
    const auto appended = append_and_wait(*log, session, 2, {"lost"});
    EXPECT_EQ(appended.error().code, Errc::kStoreFailed);
    EXPECT_THAT(appended.error().message, HasSubstr("put the store back, or restart the server"));
    EXPECT_FALSE(log->create_session("b"));
    EXPECT_FALSE(log->reopen());
    EXPECT_TRUE(log->stats().last_error);
    EXPECT_EQ(fs::exists(directory_) ? names_in(directory_) : std::set<std::string>(), left) << "nothing is created";
}

INSTANTIATE_TEST_SUITE_P(
    All, FilesWatchOf,
    testing::Values(StoreDamage{"directory_deleted", [](const auto& store) { fs::remove_all(store); }},
                    StoreDamage{"files_deleted",
                                [](const auto& store) {
                                    fs::remove_all(store);
                                    fs::create_directory(store);
                                }},
                    StoreDamage{"directory_moved",
                                [](const auto& store) { fs::rename(store, store.native() + ".away"); }},
                    StoreDamage{"directory_replaced", replace_by_a_copy},
                    StoreDamage{"lock_deleted", [](const auto& store) { fs::remove(store / kLockFile); }},
                    StoreDamage{"write_ahead_log_deleted", remove_write_ahead_log}),
    testing::PrintToStringParamName());

TEST(FilesWatch, AStoreThatIsPutBackIsReopenedWithItsEntries) {
    const TemporaryDirectory temporary;
    const auto directory = temporary.path() / "store";
    const auto log = open_rocksdb(directory).value();
    const auto session = log->create_session("a").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"durable"}));
    fs::rename(directory, temporary.path() / "away");
    ASSERT_FALSE(append_and_wait(*log, session, 2, {"lost"}));
    EXPECT_FALSE(log->reopen());

    fs::rename(temporary.path() / "away", directory);
    ASSERT_TRUE(log->reopen());
    EXPECT_THAT(entries_after(*log, session, 0).value(), ElementsAre("durable"));
    EXPECT_TRUE(append_and_wait(*log, session, 2, {"goes on"}));
}

TEST(FilesWatch, ClosingDeletesNoFilesOfAStoreThatTookItsPlace) {
    const TemporaryDirectory temporary;
    const auto directory = temporary.path() / "store";
    const auto other = temporary.path() / "other";
    static_cast<void>(open_rocksdb(other).value()->create_session("of the other").value());
    for (int start = 0; start < 3; ++start) { // file numbers continue at each start
        auto log = open_rocksdb(directory).value();
        static_cast<void>(log->create_session("a").value());
        if (start < 2) continue;
        fs::rename(directory, temporary.path() / "away");
        fs::rename(other, directory);
        const auto before = names_in(directory);
        log.reset();
        EXPECT_EQ(names_in(directory), before);
    }
    EXPECT_THAT(open_rocksdb(directory).value()->sessions().value().at(0).record.value(), "of the other");
}

TEST(FilesWatch, AFailedStoreDeletesNoFilesOfAStoreThatTookItsPlace) {
    const TemporaryDirectory temporary;
    const auto directory = temporary.path() / "store";
    const auto other = temporary.path() / "other";
    static_cast<void>(open_rocksdb(other).value()->create_session("of the other").value());
    static_cast<void>(open_rocksdb(directory).value()->create_session("a").value());
    FaultyEnv disk;
    StoreOptions options;
    options.env = disk.env.get();
    auto log = open_rocksdb(directory, options).value();
    disk.files->fail_next_log_sync();
    ASSERT_FALSE(log->create_session("b"));
    fs::rename(directory, temporary.path() / "away");
    fs::rename(other, directory);
    const auto before = names_in(directory);
    EXPECT_THAT(log->stats().last_error.value_or(""), HasSubstr("was deleted, moved or replaced"));
    EXPECT_FALSE(log->reopen());
    log.reset();
    EXPECT_EQ(names_in(directory), before);
}

TEST(FilesWatch, ALostStoreCreatesNothingWhenTheDiskHasRoomAgain) {
    const TemporaryDirectory temporary;
    const auto directory = temporary.path() / "store";
    FaultyEnv disk;
    StoreOptions options;
    options.env = disk.env.get();
    options.disk_reserve_bytes = 1000;
    disk.files->set_free_bytes(1500); // compactions pause
    const auto log = open_rocksdb(directory, options).value();
    const auto session = log->create_session("a").value();
    fs::remove_all(directory);
    fs::create_directory(directory);
    disk.files->set_free_bytes(100'000);
    EXPECT_TRUE(log->stats().last_error);
    EXPECT_FALSE(append_and_wait(*log, session, 1, {"lost"}));
    EXPECT_FALSE(log->end_of(session)) << "reading fails, too";
    EXPECT_TRUE(fs::is_empty(directory));
}

TEST(FilesWatch, RemovingSessionsDuringWritesIsNotReportedAsALoss) {
    const TemporaryDirectory temporary;
    const auto log = open_rocksdb(temporary.path() / "store").value();
    const auto session = log->create_session("a").value();
    for (Revision revision = 1; revision <= 50; ++revision) {
        const auto other = log->create_session("b").value();
        ASSERT_TRUE(log->remove_session(other)); // starts another write-ahead log
        ASSERT_TRUE(append_and_wait(*log, session, revision, {"entry"}));
    }
    EXPECT_FALSE(log->stats().last_error);
}

} // namespace
} // namespace scanloom::store
