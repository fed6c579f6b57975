#include "server/session/checkpoint.hpp"
#include "server/session/recovery.hpp"
#include "server/session/summary.hpp"
#include "server/store/record.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/stored_text.hpp"
#include "tests/support/temporary_directory.hpp"

#include "common/wire/log_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Stores that earlier versions wrote: they open, and give the maps that they gave then.
namespace scanloom::session {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class EarlierFormatsTest : public testing::Test {
protected:
    /// Two scans before its checkpoint, one behind it; the digests are of all three.
    void write(const std::string& text) {
        digests_ = store::write_store(std::filesystem::path(SCANLOOM_TEST_DATA) / text, store());
        ASSERT_FALSE(digests_.empty());
    }

    [[nodiscard]] std::filesystem::path store() const { return directory_.path() / "store"; }

    void put(std::string_view key, const std::string& value) const {
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open({}, store().native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        ASSERT_TRUE(database->Put({}, std::string(key), store::sealed(key, value)).ok());
    }

    /// The store's one session, woven.
    [[nodiscard]] Recovered recover_session() const {
        const auto log = store::open_rocksdb(store()).value();
        const auto stored = log->sessions().value();
        const auto record = wire::decode_session(stored.at(0).record.value()).value();
        EXPECT_EQ(record.name, "old");
        return recover(*log, stored.at(0).id, mapping::resolve(record.options).value(), false).value();
    }

    void expect_its_maps(Recovered& recovered) const {
        EXPECT_EQ(recovered.projection.revision(), 5U);
        EXPECT_EQ(testing_support::digests_of(recovered.projection.snapshot()), digests_);
    }

    TemporaryDirectory directory_;
    std::string digests_;
};

TEST_F(EarlierFormatsTest, AStoreOfVersion1BecomesOneOfVersion2AndIsWovenFromItsLog) {
    write("store_1_parts_1.txt");
    auto recovered = recover_session();
    EXPECT_EQ(recovered.checkpointed, std::nullopt);
    EXPECT_THAT(recovered.checkpoint_rejected.value().message, HasSubstr("parts are of version 1"));
    expect_its_maps(recovered);

    auto log = store::open_rocksdb(store()).value();
    const auto id = log->sessions().value().at(0).id;
    EXPECT_FALSE(read_summary(*log, id, {}).value()) << "it has to be woven to be listed";
    ASSERT_TRUE(store::append_and_wait(*log, id, 6, {"goes on"}));
    log.reset();
    rocksdb::DB* opened = nullptr;
    ASSERT_TRUE(rocksdb::DB::OpenForReadOnly({}, store().native(), &opened).ok());
    const std::unique_ptr<rocksdb::DB> database(opened);
    std::string format;
    ASSERT_TRUE(database->Get({}, "f", &format).ok());
    EXPECT_EQ(store::number_of(store::unsealed("f", format).value()), store::kFormatVersion);
}

TEST_F(EarlierFormatsTest, ACheckpointOfPartsVersion2IsReadAndTheRestOfTheLogFolded) {
    write("store_2_parts_2.txt");
    auto recovered = recover_session();
    EXPECT_FALSE(recovered.checkpoint_rejected);
    EXPECT_EQ(recovered.checkpointed, std::nullopt) << "the next one is to take its place";
    expect_its_maps(recovered);
    const auto robot = recovered.projection.state().robots.at(0);
    EXPECT_EQ(robot.name, "r");
    EXPECT_EQ(robot.source, "sim:1");
    EXPECT_EQ(robot.last_seq, 3U);
}

TEST_F(EarlierFormatsTest, ANewerStoreIsRefusedWithASentence) {
    write("store_2_parts_2.txt");
    put(store::kFormatKey, store::number_bytes(store::kFormatVersion + 1));
    const auto log = store::open_rocksdb(store());
    ASSERT_FALSE(log);
    EXPECT_EQ(log.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(log.error().message, AllOf(HasSubstr("newer scanloom-server (format 3, this one knows up to 2)"),
                                           HasSubstr("update the server")));
}

TEST_F(EarlierFormatsTest, ANewerCheckpointIsWovenFromTheLog) {
    write("store_2_parts_2.txt");
    const std::string newer("\x04\0\0\0\x63\0\0\0", 8); // this weaving version, parts of version 99
    put(store::part_key(1, "format"), newer);
    auto recovered = recover_session();
    EXPECT_THAT(recovered.checkpoint_rejected.value().message, HasSubstr("parts are of version 99"));
    expect_its_maps(recovered);
}

} // namespace
} // namespace scanloom::session
