#include "server/auth/audit_log.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Refusal refusal(std::string who, Reason reason = Reason::kNoToken) {
    return {Port::kRobot, reason, std::move(who), "", "lab"};
}

std::vector<std::string> lines_of(const std::vector<RefusalTable::Line>& lines) {
    std::vector<std::string> texts;
    for (const auto& line : lines) texts.push_back(fmt::format("{} {}", line.newest.who, line.count));
    return texts;
}

TEST(RefusalTable, LogsTheFirstAtOnceAndThenOneLinePerMinute) {
    RefusalTable table;
    EXPECT_THAT(lines_of(table.note(refusal("a"), 100.0)), ElementsAre("a 1"));
    for (int n = 0; n < 500; ++n) EXPECT_THAT(lines_of(table.note(refusal("a"), 100.1 + 0.1 * n)), IsEmpty());
    EXPECT_THAT(lines_of(table.note(refusal("a"), 160.0)), ElementsAre("a 500"));
    EXPECT_THAT(lines_of(table.note(refusal("a"), 219.0)), IsEmpty());
    EXPECT_THAT(lines_of(table.rest()), ElementsAre("a 2"));
    EXPECT_THAT(lines_of(table.rest()), IsEmpty());
}

TEST(RefusalTable, EachAddressAndReasonHasItsOwnLines) {
    RefusalTable table;
    EXPECT_THAT(lines_of(table.note(refusal("a"), 1.0)), ElementsAre("a 1"));
    EXPECT_THAT(lines_of(table.note(refusal("b"), 1.0)), ElementsAre("b 1"));
    EXPECT_THAT(lines_of(table.note(refusal("a", Reason::kWrongRole), 1.0)), ElementsAre("a 1"));
    EXPECT_THAT(lines_of(table.note(refusal("a", Reason::kWrongRole), 2.0)), IsEmpty());
}

TEST(RefusalTable, PendingLineIsLoggedWithTheNextRefusal) {
    RefusalTable table;
    static_cast<void>(table.note(refusal("a"), 1.0));
    static_cast<void>(table.note(refusal("a"), 2.0));
    EXPECT_THAT(lines_of(table.note(refusal("b"), 61.0)), ElementsAre("a 1", "b 1"));
}

TEST(RefusalTable, RefusalAfterAPauseIsLoggedAtOnce) {
    RefusalTable table;
    static_cast<void>(table.note(refusal("a"), 1.0));
    EXPECT_THAT(lines_of(table.note(refusal("a"), 500.0)), ElementsAre("a 1"));
}

TEST(RefusalTable, FloodFromManyAddressesIsBounded) {
    RefusalTable table;
    std::size_t lines = 0;
    for (int n = 0; n < 100'000; ++n) lines += table.note(refusal(fmt::format("10.0.{}", n)), 1.0).size();
    EXPECT_EQ(lines, RefusalTable::kEntriesMax + 1);
    EXPECT_THAT(lines_of(table.rest()), ElementsAre(fmt::format("others {}", 100'000 - RefusalTable::kEntriesMax - 1)));
}

} // namespace
} // namespace scanloom::auth
