#include "server/session/background_check.hpp"

#include "tests/unit/server/session/registry_fixture.hpp"

/// Sessions that nobody has read since the start are found damaged.
namespace scanloom::session {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Of one session, the third entry is read as something else.
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
        registry_->drain(); // with checkpoints
        registry_ = make(stored_);
        EXPECT_TRUE(registry_->recover());
        stored_.reads = 0;
        stored_.damaged = registry_->info("b")->id;
    }
    ~BackgroundCheckTest() override { checking_.join(); }

    LogWithDamage stored_;
    boost::asio::thread_pool checking_{1};
};

TEST_F(BackgroundCheckTest, FindsTheDamagedOneAndGoesOnToTheOthers) {
    BackgroundCheck check(stored_, *registry_, checking_.get_executor());
    check.start();
    check.wait();
    EXPECT_EQ(check.checked(), 3U);
    const auto damaged = check.damaged();
    ASSERT_THAT(damaged, SizeIs(1));
    EXPECT_THAT(damaged.at("b").message, HasSubstr("log entry 3: "));
    EXPECT_THAT(registry_->damaged(), IsEmpty()) << "it is served as far as it can be";
    ASSERT_TRUE(registry_->remove("b"));
    EXPECT_THAT(check.damaged(), IsEmpty()) << "it is gone";
}

TEST_F(BackgroundCheckTest, SessionsInMemoryAreNotReadAgain) {
    ASSERT_TRUE(registry_->wake("b"));
    stored_.reads = 0;
    BackgroundCheck check(stored_, *registry_, checking_.get_executor());
    check.start();
    check.wait();
    EXPECT_EQ(check.checked(), 2U);
    EXPECT_EQ(stored_.reads, 2);
}

TEST_F(BackgroundCheckTest, StopsInTheMiddleOfASession) {
    BackgroundCheck check(stored_, *registry_, checking_.get_executor(), 1e-3); // an entry takes hours
    check.start();
    check.stop();
    check.wait();
    EXPECT_EQ(check.checked(), 0U);
    EXPECT_THAT(check.damaged(), IsEmpty());
}

TEST_F(BackgroundCheckTest, WhatAFailedStoreCannotReadIsNotCalledDamaged) {
    stored_.fail_from_next_change({Errc::kStoreFailed, "the disk is gone"});
    EXPECT_FALSE(registry_->create("d", {}));
    ASSERT_TRUE(stored_.stats().last_error);
    BackgroundCheck check(stored_, *registry_, checking_.get_executor());
    check.start();
    check.wait();
    EXPECT_THAT(check.damaged(), IsEmpty());
}

TEST_F(BackgroundCheckTest, WhatOthersCouldNotReadIsDamageUnlessItMayPass) {
    BackgroundCheck check(stored_, *registry_, checking_.get_executor());
    const auto id = [&](const char* name) { return registry_->info(name)->id; };
    check.note(id("a"), {Errc::kStoreFailed, "input/output error"});
    check.note(4711, {Errc::kDataLoss, "of no session"});
    EXPECT_THAT(check.damaged(), IsEmpty());
    check.note(id("b"), {Errc::kDataLoss, "bits"});
    check.note(id("b"), {Errc::kDataLoss, "bits once more"});
    ASSERT_THAT(check.damaged(), SizeIs(1));
    EXPECT_EQ(check.damaged().at("b").message, "bits");
    stored_.fail_from_next_change({Errc::kStoreFailed, "the disk is gone"});
    EXPECT_FALSE(registry_->create("d", {}));
    check.note(id("c"), {Errc::kDataLoss, "while the store has failed"});
    EXPECT_THAT(check.damaged(), SizeIs(1));
}

TEST(ReadRate, LeavesTheTimeThatBytesAreWorthAndMakesUpForNone) {
    using std::chrono::milliseconds;
    const ReadRate::Time begin{std::chrono::hours(5)};
    ReadRate rate(1e6);
    EXPECT_EQ(rate.after(500'000, begin), begin + milliseconds(500));
    EXPECT_EQ(rate.after(500'000, begin), begin + milliseconds(1000)) << "asked at once";
    EXPECT_EQ(rate.after(1000, begin + std::chrono::hours(1)), begin + std::chrono::hours(1) + milliseconds(1));
}

} // namespace
} // namespace scanloom::session
