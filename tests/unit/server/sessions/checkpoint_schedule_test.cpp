#include "server/sessions/checkpoint_schedule.hpp"

#include <gtest/gtest.h>

namespace scanloom::sessions {
namespace {

constexpr Revision kEvery = 4096; // of session 1

TEST(CheckpointSchedule, IsDueAfterEnoughEntries) {
    CheckpointSchedule schedule(1, std::nullopt);
    EXPECT_FALSE(schedule.is_due(kEvery - 1));
    EXPECT_TRUE(schedule.is_due(kEvery));
    EXPECT_EQ(schedule.begin(kEvery), std::nullopt);
    EXPECT_FALSE(schedule.is_due(2 * kEvery)) << "one is being written";
    schedule.end(kEvery);
    EXPECT_FALSE(schedule.is_due(2 * kEvery - 1));
    EXPECT_TRUE(schedule.is_due(2 * kEvery));
}

TEST(CheckpointSchedule, CountsEntriesSinceTheStoredCheckpoint) {
    const CheckpointSchedule schedule(1, 100);
    EXPECT_FALSE(schedule.is_due(kEvery + 99));
    EXPECT_TRUE(schedule.is_due(kEvery + 100));
}

TEST(CheckpointSchedule, FailedCheckpointIsNotRetriedAtOnce) {
    CheckpointSchedule schedule(1, 100);
    EXPECT_EQ(schedule.begin(kEvery + 100), 100);
    schedule.end(100);
    EXPECT_FALSE(schedule.is_due(kEvery + 101));
    EXPECT_FALSE(schedule.is_due(2 * kEvery + 99));
    EXPECT_TRUE(schedule.is_due(2 * kEvery + 100));
    EXPECT_TRUE(schedule.is_outdated(kEvery + 100)) << "closing the session still writes one";
    EXPECT_EQ(schedule.begin(2 * kEvery + 100), 100) << "it contains the changes since the stored one";
}

TEST(CheckpointSchedule, IsDueAfterAQuarterOfTheLogIfCheckpointsGrowWithIt) {
    CheckpointSchedule schedule(1, 40'000);
    EXPECT_FALSE(schedule.is_due(49'999, true));
    EXPECT_TRUE(schedule.is_due(50'000, true));
    EXPECT_TRUE(schedule.is_due(49'999, false));
    PendingEntry entry;
    entry.entry = ScanTaken{};
    entry.reach.work = 1e10;
    schedule.count(entry);
    EXPECT_FALSE(schedule.is_due(49'999, true)) << "also after much work";
    EXPECT_FALSE(CheckpointSchedule(1, 100).is_due(kEvery + 99, true));
    EXPECT_TRUE(CheckpointSchedule(1, 100).is_due(kEvery + 100, true));
}

TEST(CheckpointSchedule, WorkMakesACheckpointDue) {
    CheckpointSchedule schedule(1, std::nullopt);
    PendingEntry entry;
    entry.entry = ScanTaken{};
    entry.reach.work = 1e10;
    schedule.count(entry);
    EXPECT_TRUE(schedule.is_due(1));
    schedule.begin(1);
    schedule.end(std::nullopt);
    EXPECT_FALSE(schedule.is_due(2));
}

} // namespace
} // namespace scanloom::sessions
