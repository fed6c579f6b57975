#include "server/sessions/recovery.hpp"

#include "server/sessions/checkpoint.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

/// Recovery of sessions from their log, and from their checkpoint where it is valid.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;

class RecoveryTest : public SessionTest {
protected:
    void SetUp() override {
        SessionTest::SetUp();
        link_ = join("r");
        submit(1, 600);
        close();
        start_session();
        link_ = join("r", false);
        submit(601, 50);
    }

    void submit(std::uint64_t first_seq, std::size_t count) {
        session_->submit(link_, random_scans(1, first_seq, count), 0);
        run();
    }

    void close() {
        session_->close({Errc::kShuttingDown, "bye"}, [] {});
        run();
    }

    void damage(const std::string& key, std::string value) {
        ASSERT_TRUE(log_.write_checkpoint(id_, {{key, std::move(value)}}));
    }

    std::shared_ptr<RecordedLink> link_;
};

TEST_F(RecoveryTest, CheckpointAndRemainingLogGiveTheMapOfTheWholeLog) {
    auto recovered = recover(log_, id_, config_, false);
    ASSERT_TRUE(recovered);
    EXPECT_EQ(recovered->checkpointed, 602U);
    EXPECT_EQ(recovered->maps.projection().revision(), 652U);
    const auto snapshot = recovered->maps.projection().snapshot();
    EXPECT_EQ(testing_support::digests_of(snapshot), digest_of_log());
    EXPECT_EQ(snapshot.robots[0].scan_count, 650U);
    EXPECT_EQ(snapshot.robots[0].trajectory.size(), 650U);
}

TEST_F(RecoveryTest, InvalidCheckpointIsReplacedByTheLog) {
    const auto parts = store::checkpoint_of(log_, id_).value();
    std::string other_version = parts.at("format");
    other_version[0] = 99;
    const std::pair<std::string, std::string> kDamages[] = {
        {"format", other_version},        {"format", "?"}, {"head", "?"}, {"robot/00000000", "short"},
        {"sensor/00000000/00000002", ""}, {"zebra", ""}, // last, because parts are never removed from a store
    };
    for (const auto& [key, value] : kDamages) {
        damage(key, value);
        auto recovered = recover(log_, id_, config_, false);
        ASSERT_TRUE(recovered) << key;
        EXPECT_EQ(recovered->checkpointed, std::nullopt) << key;
        EXPECT_EQ(recovered->maps.projection().revision(), 652U) << key;
        EXPECT_EQ(testing_support::digests_of(recovered->maps.projection().snapshot()), digest_of_log()) << key;
        if (const auto whole = parts.find(key); whole != parts.end()) damage(key, whole->second);
    }
}

TEST_F(RecoveryTest, LogShorterThanItsCheckpointIsDataLoss) {
    std::string ahead_of_the_log = store::checkpoint_of(log_, id_).value().at("head");
    ahead_of_the_log[2] = 1; // revision + 65536
    damage("head", ahead_of_the_log);
    const auto recovered = recover(log_, id_, config_, false);
    ASSERT_FALSE(recovered);
    EXPECT_EQ(recovered.error().code, Errc::kDataLoss);
    EXPECT_THAT(recovered.error().message, HasSubstr("ends before revision 66138"));
}

TEST_F(RecoveryTest, StoppedRecoveryReadsNothing) {
    const auto recovered = recover(log_, id_, config_, true);
    ASSERT_TRUE(recovered);
    EXPECT_FALSE(recovered->complete);
    EXPECT_EQ(recovered->maps.projection().revision(), 0U);
    EXPECT_FALSE(recovered->checkpoint_rejected) << "the checkpoint was not examined";
}

TEST_F(RecoveryTest, CheckpointAfterADamagedOneIsComplete) {
    damage("head", "?");
    start_session();
    close();
    const auto recovered = recover(log_, id_, config_, false);
    ASSERT_TRUE(recovered);
    EXPECT_EQ(recovered->checkpointed, 652U);
}

TEST_F(RecoveryTest, DamagedLogIsReportedByItsEntry) {
    ASSERT_TRUE(store::append_and_wait(log_, id_, 653, {"no entry"}));
    const auto recovered = recover(log_, id_, config_, false);
    ASSERT_FALSE(recovered);
    EXPECT_EQ(recovered.error().code, Errc::kDataLoss);
    EXPECT_THAT(recovered.error().message, HasSubstr("log entry 653: "));
}

TEST_F(RecoveryTest, EntryOutOfSequenceIsReported) {
    ASSERT_TRUE(store::append_and_wait(log_, id_, 653, {wire::encode_entry(ScanTaken{0, random_scan(1, 700)})}));
    const auto recovered = recover(log_, id_, config_, false);
    ASSERT_FALSE(recovered);
    EXPECT_THAT(recovered.error().message, HasSubstr("log entry 653: scan 700 of robot 'r' follows scan 650"));
}

} // namespace
} // namespace scanloom::sessions
