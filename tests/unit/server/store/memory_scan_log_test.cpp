#include "tests/support/memory_scan_log.hpp"

#include "tests/support/log_reading.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(MemoryScanLog, AFailureLastsUntilItIsReopenedAndReadingGoesOn) {
    MemoryScanLog log;
    const auto session = log.create_session("s").value();
    ASSERT_TRUE(append_and_wait(log, session, 1, {"a"}));
    log.fail_from_next_change({Errc::kStoreFailed, "disk gone"});
    EXPECT_EQ(append_and_wait(log, session, 2, {"b"}).error().message, "disk gone");
    EXPECT_EQ(append_and_wait(log, session, 2, {"b"}).error().message, "disk gone");
    EXPECT_FALSE(log.write_checkpoint(session, {}));
    EXPECT_EQ(log.stats().last_error, "disk gone");
    EXPECT_THAT(entries_after(log, session, 0).value(), ElementsAre("a"));
    log.reopen();
    EXPECT_TRUE(append_and_wait(log, session, 2, {"b"}));
}

TEST(MemoryScanLog, HeldCompletionsComeInOrderWhenReleased) {
    MemoryScanLog log;
    const auto session = log.create_session("s").value();
    std::vector<int> done;
    log.hold_completions();
    log.append(session, 1, {"a"}, [&](Result<> result) { done.push_back(result ? 1 : -1); });
    log.append(session, 2, {"b"}, [&](Result<> result) { done.push_back(result ? 2 : -2); });
    EXPECT_THAT(done, IsEmpty());
    EXPECT_EQ(log.held_completions(), 2U);
    EXPECT_EQ(log.stats().queued_bytes, 2U);
    EXPECT_THAT(entries_after(log, session, 0).value(), IsEmpty());
    log.release_completions();
    EXPECT_THAT(done, ElementsAre(1, 2));
    EXPECT_THAT(entries_after(log, session, 0).value(), ElementsAre("a", "b"));
}

TEST(MemoryScanLog, HeldCompletionsAreCalledAtTheLatestWhenItEnds) {
    int done = 0;
    {
        MemoryScanLog log;
        const auto session = log.create_session("s").value();
        log.hold_completions();
        log.append(session, 1, {"a"}, [&](Result<>) { ++done; });
    }
    EXPECT_EQ(done, 1);
}

} // namespace
} // namespace scanloom::store
