#include "server/sessions/backlog.hpp"

#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

/// Grouping of submitted entries.
namespace scanloom::sessions {
namespace {

constexpr std::int64_t kMuchRoom = 1'000'000;

/// Returns a scan that can change one chunk, in the given column.
PendingEntry scan_in(std::int32_t column, RobotIndex robot = 0, double work = 1.0) {
    PendingEntry submitted{robot, ScanTaken{robot, testing_support::random_scan(1, 1)}, {}, 10};
    submitted.reach = {SensorKind::kLaser, {64 * column, 0, 64 * column + 1, 1}, work};
    return submitted;
}

TEST(Backlog, GroupsKeepTheOrderAndLimitTheirEntries) {
    Backlog backlog;
    for (RobotIndex robot = 0; robot < 600; ++robot) backlog.add({robot, std::nullopt, {}, 0});
    RobotIndex next = 0;
    for (const std::size_t expected : {256U, 256U, 88U, 0U}) {
        const auto group = backlog.next_group(kMuchRoom);
        ASSERT_EQ(group.entries.size(), expected);
        for (const auto& entry : group.entries) ASSERT_EQ(entry.robot, next++);
    }
    EXPECT_TRUE(backlog.empty());
}

TEST(Backlog, GroupsLimitTheirWorkButContainAtLeastOneEntry) {
    Backlog backlog;
    for (const double work : {0.4 * kGroupWorkMax, 0.4 * kGroupWorkMax, 0.4 * kGroupWorkMax, 30.0 * kGroupWorkMax, 1.0})
        backlog.add(scan_in(0, 0, work));
    for (const std::size_t expected : {2U, 1U, 1U, 1U}) {
        EXPECT_EQ(backlog.next_group(kMuchRoom).entries.size(), expected);
    }
}

TEST(Backlog, GroupFitsTheRemainingChunks) {
    Backlog backlog;
    for (const std::int32_t column : {0, 0, 1, 5}) backlog.add(scan_in(column));
    const auto group = backlog.next_group(2);
    EXPECT_EQ(group.entries.size(), 3U);
    EXPECT_EQ(group.chunks, 2);
    EXPECT_EQ(backlog.next_group(0).entries.size(), 0U) << "the next entry needs one chunk";
    EXPECT_EQ(backlog.next_group(1).chunks, 1);
}

TEST(Backlog, ScansOfOneRobotShareTheirChunks) {
    Backlog backlog;
    backlog.add(scan_in(0, 0));
    backlog.add(scan_in(100, 1));
    backlog.add(scan_in(1, 0));
    backlog.add(scan_in(100, 1));
    EXPECT_EQ(backlog.next_group(kMuchRoom).chunks, 3);
}

TEST(Backlog, DropRemovesTheEntriesOfOneRobot) {
    Backlog backlog;
    for (const RobotIndex robot : {0U, 1U, 0U, 2U}) backlog.add(scan_in(0, robot));
    backlog.drop(0);
    const auto group = backlog.next_group(kMuchRoom);
    ASSERT_EQ(group.entries.size(), 2U);
    EXPECT_EQ(group.entries[0].robot, 1U);
    EXPECT_EQ(group.entries[1].robot, 2U);
}

} // namespace
} // namespace scanloom::sessions
