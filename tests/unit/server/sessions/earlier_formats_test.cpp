#include "server/sessions/checkpoint.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "server/sessions/recovery.hpp"
#include "server/sessions/summary.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_store.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/stored_text.hpp"
#include "tests/support/temporary_directory.hpp"

#include "common/wire/log_codec.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Stores written by earlier versions open and give the same maps as then.
namespace scanloom::sessions {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Key;
using testing::Not;
using testing::StartsWith;

constexpr store::SessionId kSession = 1; // each store has one session

class EarlierFormatsTest : public testing::Test {
protected:
    /// Writes a store with two scans before its checkpoint and one after it; the digests are of all three.
    void write(const std::string& text) {
        digests_ = store::write_store(std::filesystem::path(SCANLOOM_SOURCE_DIR "/tests/data") / text, store());
        ASSERT_FALSE(digests_.empty());
    }

    [[nodiscard]] std::filesystem::path store() const { return directory_.path() / "store"; }

    void put(std::string_view key, const std::string& value) const {
        rocksdb::DB* opened = nullptr;
        ASSERT_TRUE(rocksdb::DB::Open({}, store().native(), &opened).ok());
        const std::unique_ptr<rocksdb::DB> database(opened);
        ASSERT_TRUE(database->Put({}, std::string(key), store::sealed(key, value)).ok());
    }

    /// Recovers the store's session.
    [[nodiscard]] Recovered recover_session() const {
        const auto log = store::open_rocksdb(store()).value();
        const auto stored = log->sessions().value();
        const auto record = wire::decode_session(stored.at(0).record.value()).value();
        EXPECT_EQ(record.name, "old");
        return recover(*log, stored.at(0).id, mapping::resolve(record.options).value(), false).value();
    }

    void expect_its_maps(Recovered& recovered) const {
        EXPECT_EQ(recovered.maps.projection().revision(), 5U);
        EXPECT_EQ(testing_support::digests_of(recovered.maps.projection().snapshot()), digests_);
    }

    TemporaryDirectory directory_;
    std::string digests_;
};

TEST_F(EarlierFormatsTest, StoreOfVersion1IsUpgradedAndItsLogApplied) {
    write("store_1_parts_1.txt");
    auto recovered = recover_session();
    EXPECT_EQ(recovered.checkpointed, std::nullopt);
    EXPECT_THAT(recovered.checkpoint_rejected.value().message, HasSubstr("parts are of version 1"));
    expect_its_maps(recovered);

    auto log = store::open_rocksdb(store()).value();
    const auto id = log->sessions().value().at(0).id;
    EXPECT_FALSE(read_summary(*log, id, {}).value()) << "the summary needs a recovery";
    ASSERT_TRUE(store::append_and_wait(*log, id, 6, {"goes on"}));
    log.reset();
    rocksdb::DB* opened = nullptr;
    ASSERT_TRUE(rocksdb::DB::OpenForReadOnly({}, store().native(), &opened).ok());
    const std::unique_ptr<rocksdb::DB> database(opened);
    std::string format;
    ASSERT_TRUE(database->Get({}, "f", &format).ok());
    EXPECT_EQ(store::number_of(store::unsealed("f", format).value()), store::kFormatVersion);
}

/// The parameter is the version of the checkpoint's parts.
class EarlierCheckpointTest : public EarlierFormatsTest, public testing::WithParamInterface<int> {
protected:
    void SetUp() override { write(fmt::format("store_2_parts_{}.txt", GetParam())); }

    static CheckpointReader checkpoint_in(store::ScanLog& log, const mapping::MapConfig& config) {
        CheckpointReader reader(config);
        for (const auto& [key, value] : store::checkpoint_of(log, kSession).value()) {
            EXPECT_TRUE(reader.add(key, value)) << key;
        }
        return reader;
    }
};

TEST_P(EarlierCheckpointTest, IsReadAndTheRemainingLogApplied) {
    auto recovered = recover_session();
    EXPECT_FALSE(recovered.checkpoint_rejected);
    EXPECT_EQ(recovered.checkpointed, std::nullopt) << "the next checkpoint replaces it";
    expect_its_maps(recovered);
    const auto robot = recovered.maps.projection().state().robots.at(0);
    EXPECT_EQ(robot.name, "r");
    EXPECT_EQ(robot.source, "sim:1");
    EXPECT_EQ(robot.last_seq, 3U);
}

TEST_P(EarlierCheckpointTest, ContainsTheRobotsSummary) {
    const auto log = store::open_rocksdb(store()).value();
    auto reader = checkpoint_in(*log, mapping::MapConfig{});
    EXPECT_FALSE(reader.is_newest_format());
    auto maps = std::move(reader).finish().value();
    auto& projection = maps.projection();
    EXPECT_EQ(projection.revision(), 4U);
    const auto summary = summary_of(projection.snapshot());
    const auto& robot = summary.facts->robots.at(0);
    EXPECT_EQ(robot.name, "r");
    EXPECT_EQ(robot.body_radius, 0.2);
    EXPECT_EQ(robot.last_seq, 2U);
    EXPECT_EQ(robot.scan_count, 2U);
    EXPECT_EQ(robot.stamp, 102.0);
    EXPECT_EQ(robot.pose, (Pose2{1.2, 1.6, 0.6}));
}

TEST_P(EarlierCheckpointTest, IsReplacedByTheNewestFormatWithASummary) {
    auto recovered = recover_session();
    const auto log = store::open_rocksdb(store()).value();
    const auto config = recovered.maps.projection().config();
    const auto state = recovered.maps.projection().state();
    ASSERT_TRUE(
        write_checkpoint(*log, kSession, recovered.maps.projection().snapshot(), state, recovered.checkpointed, false));

    EXPECT_THAT(store::checkpoint_of(*log, kSession).value(), Each(Key(Not(StartsWith("track/")))))
        << "no part of the earlier checkpoint remains";
    EXPECT_TRUE(checkpoint_in(*log, config).is_newest_format());
    const auto summary = read_summary(*log, kSession, config).value();
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->facts->revision, 5U);
    EXPECT_EQ(summary->facts->robots.at(0).scan_count, 3U);
    EXPECT_EQ(summary->pages, state.pages);
}

INSTANTIATE_TEST_SUITE_P(OfParts, EarlierCheckpointTest, testing::Values(2, 3),
                         [](const auto& version) { return fmt::format("Version{}", version.param); });

TEST_F(EarlierFormatsTest, NewerStoreIsRefusedWithAMessage) {
    write("store_2_parts_2.txt");
    put(store::kFormatKey, store::number_bytes(store::kFormatVersion + 1));
    const auto log = store::open_rocksdb(store());
    ASSERT_FALSE(log);
    EXPECT_EQ(log.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(log.error().message, AllOf(HasSubstr("newer scanloom-server (format 5, this one knows up to 4)"),
                                           HasSubstr("update the server")));
}

TEST_F(EarlierFormatsTest, NewerCheckpointIsReplacedByTheLog) {
    write("store_2_parts_2.txt");
    const std::string newer("\x04\0\0\0\x63\0\0\0", 8); // this mapping version, parts of version 99
    put(store::part_key(kSession, "format"), newer);
    auto recovered = recover_session();
    EXPECT_THAT(recovered.checkpoint_rejected.value().message, HasSubstr("parts are of version 99"));
    expect_its_maps(recovered);
}

/// A session with max_jump, a jump, and exclusions before and after its checkpoint.
TEST_F(EarlierFormatsTest, StoreOfVersion3KeepsExclusionsAndJumps) {
    write("store_3_parts_4.txt");
    auto recovered = recover_session();
    EXPECT_FALSE(recovered.checkpoint_rejected);
    EXPECT_EQ(testing_support::digests_of(recovered.maps.projection().snapshot()), digests_);
    const auto state = recovered.maps.projection().state();
    EXPECT_EQ(state.revision, 11U);
    EXPECT_EQ(state.robots.at(0).scan_count, 2U);
    EXPECT_EQ(state.robots.at(0).excluded, 2U);
    EXPECT_EQ(state.robots.at(0).jumps.left_out, 1U);
    EXPECT_EQ(state.exclusions->count_in_effect(), 2U);

    const auto log = store::open_rocksdb(store()).value();
    CheckpointReader reader(recovered.maps.projection().config());
    for (const auto& [key, value] : store::checkpoint_of(*log, kSession).value())
        EXPECT_TRUE(reader.add(key, value)) << key;
    EXPECT_TRUE(reader.is_newest_format());
    EXPECT_EQ(std::move(reader).finish().value().projection().exclusions()->all(), state.exclusions->as_of(9).all());
}

/// Newest format: a robot without poses, whose scans follow its odometry because it has no laser.
TEST_F(EarlierFormatsTest, StoreOfVersion4KeepsTheKindOfPosesAndCorrections) {
    write("store_4_estimated_poses.txt");
    auto recovered = recover_session();
    EXPECT_EQ(recovered.maps.announced(), 3U);
    EXPECT_EQ(recovered.maps.projection().robots().at(0).poses, Poses::kOdometry);
    EXPECT_EQ(recovered.maps.projection().revision(), 6U);
    const auto maps = recovered.maps.projection().snapshot();
    EXPECT_EQ(testing_support::digests_of(maps), digests_);
    for (const std::uint64_t seq : {1U, 2U, 3U}) {
        EXPECT_EQ(maps.scan_poses.find(0, seq), (Pose2{0.5 * static_cast<double>(seq), 1.0, 0.25})) << seq;
    }
}

} // namespace
} // namespace scanloom::sessions
