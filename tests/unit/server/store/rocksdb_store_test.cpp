#include "server/store/rocksdb_store.hpp"

#include "server/store/record.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>

#include <map>
#include <memory>

/// Stores that are opened for reading only.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A copy of a store that was killed with entries in a table and in its write-ahead log.
class ReadOnlyStoreTest : public testing::Test {
protected:
    ReadOnlyStoreTest() {
        const auto original = directory_.path() / "original";
        {
            auto log = open_rocksdb(original).value();
            session_ = log->create_session("a session").value();
            append_and_wait(*log, session_, 1, distinct_entries(session_, 1, 50)).value();
        }
        auto log = open_rocksdb(original).value();
        append_and_wait(*log, session_, 51, distinct_entries(session_, 51, 10)).value();
        log->write_checkpoint(session_, {{"part", "value"}}).value();
        copy_store(original, copy());
    }

    [[nodiscard]] fs::path copy() const { return directory_.path() / "copy"; }

    TemporaryDirectory directory_;
    SessionId session_ = 0;
};

TEST_F(ReadOnlyStoreTest, HasEverythingAndChangesNoByte) {
    const auto before = files_in(copy());
    {
        const auto store = open_read_only(copy()).value();
        EXPECT_EQ(entries_after(*store.log, session_, 0).value(), distinct_entries(session_, 1, 60));
        EXPECT_EQ(checkpoint_of(*store.log, session_).value().at("part"), "value");
        EXPECT_EQ(store.unfinished_bytes, 0U);
        EXPECT_THAT(store.without_record, IsEmpty());
        EXPECT_FALSE(append_and_wait(*store.log, session_, 61, {"never"}));
    }
    EXPECT_EQ(files_in(copy()), before);
}

TEST_F(ReadOnlyStoreTest, AnUnfinishedWriteIsReportedAndStays) {
    const auto log = only_file_like(copy(), ".log");
    fs::resize_file(log, fs::file_size(log) - 3);
    const auto before = files_in(copy());
    {
        const auto store = open_read_only(copy()).value();
        EXPECT_GT(store.unfinished_bytes, 0U);
        EXPECT_EQ(entries_after(*store.log, session_, 0).value(), distinct_entries(session_, 1, 60));
        EXPECT_THAT(checkpoint_of(*store.log, session_).value(), IsEmpty()) << "written last";
    }
    EXPECT_EQ(files_in(copy()), before);
}

TEST_F(ReadOnlyStoreTest, DamageThatAStartWouldRefuseIsReported) {
    flip_bit(only_file_like(copy(), ".log"), 40, 1);
    EXPECT_THAT(open_read_only(copy()).error().message, HasSubstr(".log of the store is damaged"));
    copy_store(directory_.path() / "original", copy());
    flip_bit(only_file_like(copy(), "MANIFEST-"), 40, 1);
    EXPECT_THAT(open_read_only(copy()).error().message, HasSubstr("MANIFEST-"));
    copy_store(directory_.path() / "original", copy());
    fs::remove(only_file_like(copy(), ".sst"));
    EXPECT_EQ(open_read_only(copy()).error().code, Errc::kDataLoss);
}

TEST_F(ReadOnlyStoreTest, AStoreInUseIsRefusedAndOtherReadersAreAdmitted) {
    {
        const auto server = open_rocksdb(copy()).value();
        EXPECT_EQ(open_read_only(copy()).error().code, Errc::kConflict);
    }
    const auto one = open_read_only(copy()).value();
    EXPECT_TRUE(open_read_only(copy()));
    EXPECT_EQ(open_rocksdb(copy()).error().code, Errc::kConflict) << "no server may write meanwhile";
}

TEST_F(ReadOnlyStoreTest, WithoutAStoreNoneIsCreated) {
    const auto nowhere = directory_.path() / "nowhere";
    EXPECT_EQ(open_read_only(nowhere).error().code, Errc::kNotFound);
    EXPECT_FALSE(fs::exists(nowhere));
    fs::create_directory(nowhere);
    EXPECT_EQ(open_read_only(nowhere).error().code, Errc::kNotFound);
    EXPECT_TRUE(fs::is_empty(nowhere));
}

TEST_F(ReadOnlyStoreTest, SessionsWithoutARecordAreReported) {
    {
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open({}, copy().native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        ASSERT_TRUE(database->Put({}, entry_key(7, 1), "without a record").ok());
        ASSERT_TRUE(database->Put({}, part_key(9, "part"), "without a record").ok());
    }
    EXPECT_THAT(open_read_only(copy()).value().without_record, ElementsAre(7, 9));
}

} // namespace
} // namespace scanloom::store
