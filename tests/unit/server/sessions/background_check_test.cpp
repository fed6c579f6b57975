#include "server/sessions/background_check.hpp"

#include "tests/unit/server/sessions/registry_fixture.hpp"

/// The background check finds damaged sessions that have not been read since the server started.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Returns an invalid third entry when the damaged session is read.
class LogWithDamage final : public store::MemoryScanLog {
public:
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        ++reads;
        return MemoryScanLog::read(session, after, [&](Revision revision, std::string_view entry) {
            return visit(revision, session == damaged && revision == 3 ? "no entry" : entry);
        });
    }

    std::atomic<store::SessionId> damaged = 0;
    std::atomic<int> reads = 0;
};

class BackgroundCheckTest : public SessionRegistryTest {
protected:
    BackgroundCheckTest() {
        registry_ = make(stored_);
        EXPECT_TRUE(registry_->recover());
        for (const auto* name : {"a", "b", "c"}) stream(*registry_->create(name, {}).value(), "r", 3);
        registry_->drain(); // writes checkpoints
        registry_ = make(stored_);
        EXPECT_TRUE(registry_->recover());
        stored_.reads = 0;
        stored_.damaged = registry_->info("b")->id;
    }

    LogWithDamage stored_;
};

TEST_F(BackgroundCheckTest, ReportsDamagedSessionAndChecksTheOthers) {
    BackgroundCheck check(stored_, *registry_);
    check.start();
    check.wait();
    EXPECT_EQ(check.checked(), 3U);
    const auto damaged = check.damaged();
    ASSERT_THAT(damaged, SizeIs(1));
    EXPECT_THAT(damaged.at("b").message, HasSubstr("log entry 3: "));
    EXPECT_THAT(registry_->damaged(), IsEmpty()) << "the check does not stop the session from being served";
    ASSERT_TRUE(registry_->remove("b"));
    EXPECT_THAT(check.damaged(), IsEmpty()) << "the removed session is no longer listed";
}

TEST_F(BackgroundCheckTest, SkipsLoadedSessions) {
    ASSERT_TRUE(registry_->load("b"));
    stored_.reads = 0;
    BackgroundCheck check(stored_, *registry_);
    check.start();
    check.wait();
    EXPECT_EQ(check.checked(), 2U);
    EXPECT_EQ(stored_.reads, 2);
}

TEST_F(BackgroundCheckTest, StopsWithinASession) {
    BackgroundCheck check(stored_, *registry_, 1e-3); // each entry takes hours at this rate
    check.start();
    check.stop();
    check.wait();
    EXPECT_EQ(check.checked(), 0U);
    EXPECT_THAT(check.damaged(), IsEmpty());
}

TEST_F(BackgroundCheckTest, ReportsNoDamageWhileTheStoreHasFailed) {
    stored_.fail_from_next_change({Errc::kStoreFailed, "the disk is gone"});
    EXPECT_FALSE(registry_->create("d", {}));
    ASSERT_TRUE(stored_.stats().last_error);
    BackgroundCheck check(stored_, *registry_);
    check.start();
    check.wait();
    EXPECT_THAT(check.damaged(), IsEmpty());
}

TEST_F(BackgroundCheckTest, NotesDataLossButNoTransientErrors) {
    BackgroundCheck check(stored_, *registry_);
    const auto id = [&](const char* name) { return registry_->info(name)->id; };
    check.note(id("a"), {Errc::kStoreFailed, "input/output error"});
    check.note(4711, {Errc::kDataLoss, "unknown session"});
    EXPECT_THAT(check.damaged(), IsEmpty());
    check.note(id("b"), {Errc::kDataLoss, "wrong bits"});
    check.note(id("b"), {Errc::kDataLoss, "wrong bits again"});
    ASSERT_THAT(check.damaged(), SizeIs(1));
    EXPECT_EQ(check.damaged().at("b").message, "wrong bits");
    stored_.fail_from_next_change({Errc::kStoreFailed, "the disk is gone"});
    EXPECT_FALSE(registry_->create("d", {}));
    check.note(id("c"), {Errc::kDataLoss, "while the store has failed"});
    EXPECT_THAT(check.damaged(), SizeIs(1));
}

} // namespace
} // namespace scanloom::sessions
