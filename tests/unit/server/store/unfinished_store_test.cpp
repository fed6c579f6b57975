#include "server/store/unfinished_store.hpp"

#include "server/store/damaged_store.hpp"
#include "server/store/rocksdb_store.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Stores that a repair writes, and leftovers of killed repairs.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

class UnfinishedStoreTest : public testing::Test {
protected:
    [[nodiscard]] Result<UnfinishedStore> begin() const { return UnfinishedStore::begin(at("new"), at("new.lost")); }

    [[nodiscard]] fs::path at(const char* name) const { return directory_.path() / name; }

    /// Writes what a repair may have written before it is killed.
    void write_most_of(const UnfinishedStore& unfinished) const {
        const auto log = unfinished.open_log().value();
        const auto session = log->create_session("one").value();
        append_and_wait(*log, session, 1, distinct_entries(session, 1, 10)).value();
        fs::create_directories(at("new.lost"));
        write_bytes(at("new.lost") / "one.scanlog", "set aside");
    }

    TemporaryDirectory directory_;
};

TEST_F(UnfinishedStoreTest, IsRefusedUntilItIsFinished) {
    auto unfinished = begin().value();
    write_most_of(unfinished);
    for (int turn = 0; turn < 2; ++turn) {
        EXPECT_THAT(open_rocksdb(at("new")).error().message, HasSubstr("is unfinished"));
        EXPECT_THAT(open_read_only(at("new")).error().message, HasSubstr("is unfinished"));
        EXPECT_THAT(DamagedStore::open(at("new")).error().message, HasSubstr("is unfinished"));
    }
    ASSERT_TRUE(unfinished.finish());
    EXPECT_EQ(bytes_of(at("new.lost") / "one.scanlog"), "set aside");
    const auto log = open_rocksdb(at("new")).value();
    EXPECT_THAT(entries_after(*log, 1, 0).value(), SizeIs(10));
}

TEST_F(UnfinishedStoreTest, TheNextRepairRemovesTheFilesOfAKilledOne) {
    write_most_of(begin().value());
    auto unfinished = begin();
    ASSERT_TRUE(unfinished) << unfinished.error().message;
    EXPECT_FALSE(fs::exists(at("new.lost") / "one.scanlog"));
    EXPECT_THAT(files_like(at("new"), ""), SizeIs(1)) << "only the mark";
    ASSERT_TRUE(unfinished->finish());
    EXPECT_TRUE(fs::is_empty(at("new")));
}

TEST_F(UnfinishedStoreTest, ASecondRepairAtTheSameTimeIsRefused) {
    const auto unfinished = begin().value();
    write_most_of(unfinished);
    EXPECT_THAT(begin().error().message, HasSubstr("another program is writing a store into it"));
    EXPECT_EQ(bytes_of(at("new.lost") / "one.scanlog"), "set aside");
}

TEST_F(UnfinishedStoreTest, OtherFilesStay) {
    for (const auto* mine : {"new/mine", "new.lost/mine", "new/000001.sst", "new.lost/one.scanlog"}) {
        fs::create_directories(at(mine).parent_path());
        write_bytes(at(mine), "mine");
        EXPECT_EQ(begin().error().code, Errc::kConflict) << mine;
        EXPECT_EQ(bytes_of(at(mine)), "mine");
        EXPECT_THAT(files_like(at(mine).parent_path(), ""), SizeIs(1)) << "no mark is left there";
        fs::remove_all(at("new"));
        fs::remove_all(at("new.lost"));
    }
}

TEST_F(UnfinishedStoreTest, OtherFilesStayNextToThoseOfAKilledRepair) {
    for (const auto* mine : {"new/mine", "new.lost/mine"}) {
        write_most_of(begin().value());
        write_bytes(at(mine), "mine");
        EXPECT_THAT(begin().error().message, HasSubstr("(mine)"));
        EXPECT_EQ(bytes_of(at(mine)), "mine");
        EXPECT_EQ(bytes_of(at("new.lost") / "one.scanlog"), "set aside") << "no other file is removed";
        fs::remove(at(mine));
    }
}

TEST_F(UnfinishedStoreTest, AFinishedStoreIsNotRemovedAsALeftover) {
    auto unfinished = begin().value();
    write_most_of(unfinished);
    ASSERT_TRUE(unfinished.finish());
    write_bytes(at("new") / "scanloom.unfinished", ""); // as a concurrent repair would create it
    EXPECT_EQ(begin().error().code, Errc::kConflict);
    EXPECT_TRUE(open_rocksdb(at("new")));
}

} // namespace
} // namespace scanloom::store
