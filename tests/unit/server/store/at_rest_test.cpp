#include "server/store/at_rest.hpp"

#include "server/store/record.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/db.h>

#include <map>
#include <memory>

/// Stores that are looked at and not touched.
namespace scanloom::store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A copy of a store that was killed with entries in a table and in its write-ahead log.
class AtRestTest : public testing::Test {
protected:
    AtRestTest() {
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

TEST_F(AtRestTest, HasEverythingAndChangesNotAByte) {
    const auto before = files_in(copy());
    {
        const auto store = open_at_rest(copy()).value();
        EXPECT_EQ(entries_after(*store.log, session_, 0).value(), distinct_entries(session_, 1, 60));
        EXPECT_EQ(checkpoint_of(*store.log, session_).value().at("part"), "value");
        EXPECT_EQ(store.unfinished_bytes, 0U);
        EXPECT_THAT(store.without_record, IsEmpty());
        EXPECT_FALSE(append_and_wait(*store.log, session_, 61, {"never"}));
    }
    EXPECT_EQ(files_in(copy()), before);
}

TEST_F(AtRestTest, AnUnfinishedWriteIsToldAndStays) {
    const auto log = only_file_like(copy(), ".log");
    fs::resize_file(log, fs::file_size(log) - 3);
    const auto before = files_in(copy());
    {
        const auto store = open_at_rest(copy()).value();
        EXPECT_GT(store.unfinished_bytes, 0U);
        EXPECT_EQ(entries_after(*store.log, session_, 0).value(), distinct_entries(session_, 1, 60));
        EXPECT_THAT(checkpoint_of(*store.log, session_).value(), IsEmpty()) << "written last";
    }
    EXPECT_EQ(files_in(copy()), before);
}

TEST_F(AtRestTest, DamageThatAStartWouldRefuseIsTold) {
    flip_bit(only_file_like(copy(), ".log"), 40, 1);
    EXPECT_THAT(open_at_rest(copy()).error().message, HasSubstr(".log of the store is damaged"));
    copy_store(directory_.path() / "original", copy());
    flip_bit(only_file_like(copy(), "MANIFEST-"), 40, 1);
    EXPECT_THAT(open_at_rest(copy()).error().message, HasSubstr("MANIFEST-"));
    copy_store(directory_.path() / "original", copy());
    fs::remove(only_file_like(copy(), ".sst"));
    EXPECT_EQ(open_at_rest(copy()).error().code, Errc::kDataLoss);
}

TEST_F(AtRestTest, AStoreInUseIsRefusedAndOthersMayLookToo) {
    {
        const auto server = open_rocksdb(copy()).value();
        EXPECT_EQ(open_at_rest(copy()).error().code, Errc::kConflict);
    }
    const auto one = open_at_rest(copy()).value();
    EXPECT_TRUE(open_at_rest(copy()));
    EXPECT_EQ(open_rocksdb(copy()).error().code, Errc::kConflict) << "nobody may write meanwhile";
}

TEST_F(AtRestTest, WhereThereIsNoStoreNoneIsMade) {
    const auto nowhere = directory_.path() / "nowhere";
    EXPECT_EQ(open_at_rest(nowhere).error().code, Errc::kNotFound);
    EXPECT_FALSE(fs::exists(nowhere));
    fs::create_directory(nowhere);
    EXPECT_EQ(open_at_rest(nowhere).error().code, Errc::kNotFound);
    EXPECT_TRUE(fs::is_empty(nowhere));
}

TEST_F(AtRestTest, SessionsWithoutARecordAreTold) {
    {
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open({}, copy().native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        ASSERT_TRUE(database->Put({}, entry_key(7, 1), "of nobody").ok());
        ASSERT_TRUE(database->Put({}, part_key(9, "part"), "of nobody").ok());
    }
    EXPECT_THAT(open_at_rest(copy()).value().without_record, ElementsAre(7, 9));
}

} // namespace
} // namespace scanloom::store
