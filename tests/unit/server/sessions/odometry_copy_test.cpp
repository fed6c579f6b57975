#include "server/sessions/odometry_copy.hpp"

#include "common/wire/log_codec.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/unit/server/sessions/registry_fixture.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Copies of sessions whose poses are to be estimated, and what a crash leaves of them.
namespace scanloom::sessions {
namespace {

class OdometryCopyTest : public SessionRegistryTest {
protected:
    void SetUp() override {
        const auto session = registry_->create("lab", {}).value();
        stream(*session, "robot", 5);
        id_ = session->info().id;
        registry_->drain();
    }

    std::vector<LogEntry> entries(store::SessionId session) {
        std::vector<LogEntry> entries;
        for (const auto& bytes : store::entries_after(log_, session, 0).value()) {
            entries.push_back(wire::decode_entry(bytes).value());
        }
        return entries;
    }

    std::vector<store::SessionId> settled() {
        std::vector<store::SessionId> ids;
        for (const auto& session : settle_copies(log_, log_.sessions().value()).value()) ids.push_back(session.id);
        EXPECT_EQ(log_.sessions().value().size(), ids.size());
        return ids;
    }

    /// Stores the first entries of a copy, as a crash leaves them.
    store::SessionId store_part_of_copy(std::size_t count) {
        const auto whole = copy_as_odometry(log_, id_, false).value();
        const auto all = log_.sessions().value();
        const auto record = std::ranges::find(all, whole, &store::StoredSession::id)->record.value();
        auto first = store::entries_after(log_, whole, 0).value();
        first.resize(count);
        EXPECT_TRUE(log_.remove_session(whole));
        const auto part = log_.create_session(record).value();
        EXPECT_TRUE(store::append_and_wait(log_, part, 1, std::move(first)));
        return part;
    }

    store::SessionId id_ = 0;
};

TEST_F(OdometryCopyTest, EveryEntryIsTheSameButForItsPoses) {
    const auto before = entries(id_);
    const auto copy = entries(copy_as_odometry(log_, id_, false).value());
    ASSERT_EQ(copy.size(), before.size());
    std::size_t scans = 0;
    for (std::size_t n = 0; n < copy.size(); ++n) {
        LogEntry expected = before[n];
        if (auto* joined = std::get_if<RobotJoined>(&expected)) joined->poses = Poses::kOdometry;
        if (auto* taken = std::get_if<ScanTaken>(&expected)) {
            ++scans;
            taken->scan.odometry = taken->scan.pose;
            taken->scan.pose.reset();
        }
        EXPECT_EQ(copy[n], expected) << n;
    }
    EXPECT_EQ(scans, 5U);
}

TEST_F(OdometryCopyTest, CompleteCopyReplacesItsSession) {
    const auto copy = copy_as_odometry(log_, id_, false).value();
    EXPECT_THAT(settled(), testing::ElementsAre(copy));
    EXPECT_THAT(settled(), testing::ElementsAre(copy)) << "also when the session is gone";
}

TEST_F(OdometryCopyTest, IncompleteCopyIsRemoved) {
    const auto all = entries(id_).size();
    for (const std::size_t count : {std::size_t{1}, all - 1}) {
        store_part_of_copy(count);
        EXPECT_THAT(settled(), testing::ElementsAre(id_)) << count;
    }
}

TEST_F(OdometryCopyTest, SessionThatWentOnIsNotReplaced) {
    static_cast<void>(copy_as_odometry(log_, id_, false).value());
    auto next = std::get<ScanTaken>(entries(id_).back());
    ++next.scan.seq;
    const auto end = entries(id_).size();
    ASSERT_TRUE(store::append_and_wait(log_, id_, end + 1, {wire::encode_entry(next)}));
    EXPECT_THAT(settled(), testing::ElementsAre(id_));
    EXPECT_EQ(entries(id_).size(), end + 1);
}

TEST_F(OdometryCopyTest, NextCopyAndDeletionRemoveWhatFailedRequestsLeft) {
    store_part_of_copy(3);
    const auto copy = copy_as_odometry(log_, id_, false).value();
    EXPECT_EQ(log_.sessions().value().size(), 2U);
    EXPECT_EQ(entries(copy).size(), entries(id_).size());
    restart();
    static_cast<void>(copy_as_odometry(log_, registry_->info("lab")->id, false));
    ASSERT_TRUE(registry_->remove("lab"));
    EXPECT_THAT(log_.sessions().value(), testing::IsEmpty());
    registry_->drain();
}

TEST_F(OdometryCopyTest, StoppedCopyLeavesNothing) {
    const std::atomic<bool> stop = true;
    const auto copy = copy_as_odometry(log_, id_, stop);
    ASSERT_FALSE(copy);
    EXPECT_EQ(copy.error().code, Errc::kShuttingDown);
    EXPECT_THAT(settled(), testing::ElementsAre(id_));
}

TEST_F(OdometryCopyTest, AfterACrashTheServerHasOneOfBoth) {
    store_part_of_copy(3);
    restart();
    EXPECT_TRUE(registry_->damaged().empty());
    ASSERT_EQ(registry_->all().size(), 1U);
    EXPECT_EQ(registry_->load("lab").value()->snapshot()->robots.at(0).poses, Poses::kMap);

    registry_->drain();
    static_cast<void>(copy_as_odometry(log_, id_, false).value());
    restart();
    EXPECT_TRUE(registry_->damaged().empty());
    ASSERT_EQ(registry_->all().size(), 1U);
    const auto session = registry_->load("lab").value();
    EXPECT_EQ(session->snapshot()->robots.at(0).poses, Poses::kOdometry);
    EXPECT_EQ(session->snapshot()->robots.at(0).last_seq, 5U);
    registry_->drain();
}

TEST_F(OdometryCopyTest, RobotsContinueWithOdometry) {
    restart();
    const auto session = registry_->load("lab").value();
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*session, "robot", link));
    EXPECT_EQ(registry_->estimate("lab").error().code, Errc::kConflict) << "it would have to state other poses";
    session->leave(link);
    wait_for_posted_tasks();
    EXPECT_EQ(registry_->estimate("lab").value().id, id_);
    const auto estimated = registry_->load("lab").value();
    EXPECT_NE(estimated->info().id, id_);
    EXPECT_EQ(join_and_wait(*estimated, "robot", link).error().code, Errc::kConflict);
    ASSERT_TRUE(log_.write_checkpoint(estimated->info().id, {{"head", "?"}}));
    EXPECT_EQ(registry_->estimate("lab").value().id, estimated->info().id) << "its poses are estimated already";
    EXPECT_THAT(store::checkpoint_of(log_, estimated->info().id).value(), testing::IsEmpty())
        << "they are estimated again";
    EXPECT_EQ(registry_->load("lab").value()->info().id, estimated->info().id);
    registry_->drain();
    EXPECT_EQ(registry_->estimate("lab").error().code, Errc::kShuttingDown);
}

} // namespace
} // namespace scanloom::sessions
