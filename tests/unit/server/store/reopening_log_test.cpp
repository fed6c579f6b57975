#include "server/store/reopening_log.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace scanloom::store {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

TEST(ReopeningLog, TellsOfLogsThatCannotBeRead) {
    MemoryScanLog* inner = nullptr;
    const auto log = ReopeningLog::open([&]() -> Result<std::unique_ptr<ScanLog>> {
                         auto opened = std::make_unique<MemoryScanLog>();
                         inner = opened.get();
                         return std::unique_ptr<ScanLog>(std::move(opened));
                     }).value();
    std::vector<std::pair<SessionId, Errc>> told;
    log->on_unreadable([&](SessionId session, const Error& why) { told.emplace_back(session, why.code); });
    ASSERT_TRUE(log->create_session("a"));
    const auto session = log->create_session("b").value();
    ASSERT_TRUE(append_and_wait(*log, session, 1, {"entry"}));
    EXPECT_TRUE(entries_after(*log, session, 0));
    const Error readers_own{Errc::kMalformed, "enough"};
    EXPECT_EQ(log->read(session, 0, [&](Revision, std::string_view) -> Result<> { return readers_own; }).error(),
              readers_own);
    EXPECT_FALSE(log->read(99, 0, [](Revision, std::string_view) -> Result<> { return {}; }));
    EXPECT_THAT(told, IsEmpty());
    for (const auto code : {Errc::kDataLoss, Errc::kStoreFailed}) {
        inner->fail_reading(Error{code, "no"});
        EXPECT_FALSE(entries_after(*log, session, 0));
        ASSERT_FALSE(told.empty());
        EXPECT_EQ(told.back(), std::pair(session, code));
    }
    EXPECT_THAT(told, SizeIs(2));
}

} // namespace
} // namespace scanloom::store
