#include "lab/alignment_trials.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

double no_time() { return 0.0; }

robot::World room() { return trial_worlds().front(); }

void expect_same(const Trials& a, const Trials& b) {
    ASSERT_EQ(a.each.size(), b.each.size());
    for (std::size_t n = 0; n < a.each.size(); ++n) {
        EXPECT_EQ(a.each[n].seed, b.each[n].seed);
        EXPECT_EQ(a.each[n].found, b.each[n].found);
        EXPECT_EQ(a.each[n].verdict, b.each[n].verdict);
    }
}

TEST(AlignmentTrials, UseARoomTheRoomsOfAnOfficeAndAHall) {
    const auto worlds = trial_worlds();
    ASSERT_EQ(worlds.size(), 3U);
    EXPECT_EQ(worlds[0].name, "room");
    EXPECT_EQ(worlds[1].name, "office");
    EXPECT_EQ(worlds[2].name, "hall");
    EXPECT_TRUE(worlds[1].starts.front().contains({-12.0, 8.0}))
        << "the robot must start in a room, not in the corridor";
}

TEST(AlignmentTrials, AreRightAndDeterministicInARoom) {
    const auto row = try_alignment(room(), 1, 4, no_time).value();
    EXPECT_EQ(row.world, "room");
    EXPECT_EQ(row.trials.count(Verdict::kRight), 4U);
    EXPECT_GT(row.trials.worst().metres, 0.0);
    expect_same(row.trials, try_alignment(room(), 1, 4, no_time)->trials);
    EXPECT_FALSE(row.trials.each[0].found == try_alignment(room(), 2, 1, no_time)->trials.each[0].found);
}

TEST(LocatingTrials, AreRightInARoom) {
    const auto row = try_locating(room(), 3, 1, 3, no_time).value();
    EXPECT_EQ(row.seen, "room");
    EXPECT_EQ(row.captures, 3U);
    EXPECT_EQ(row.trials.count(Verdict::kRight), 3U);
    const auto& trial = row.trials.each[1];
    const auto scene = located_scene(room(), 3, trial.seed);
    EXPECT_EQ(scene.map.size(), 3U);
    EXPECT_LT(pose_error(trial.found, scene.truth).metres, kRightDistance) << "the scene must be the one of the trial";
}

TEST(LocatingTrials, MatchAtTheGroundTruthIsComputedOnlyForWrongTrials) {
    const auto row = try_locating(trial_worlds()[2], 1, 1, 9, no_time).value();
    for (const Trial& trial : row.trials.each) {
        EXPECT_EQ(trial.explained_at_truth.has_value(),
                  trial.verdict == Verdict::kWrong && trial.error.metres > kElsewhere);
    }
    EXPECT_GT(row.trials.count(Verdict::kRight), 3U);
}

TEST(LocatingTrials, RefuseViewsOfAnotherWorld) {
    const auto row = try_strangers(room(), trial_worlds()[1], 4, 1, 3, no_time).value();
    EXPECT_EQ(row.seen, "room");
    EXPECT_EQ(row.map, "office");
    EXPECT_EQ(row.trials.each.size(), 3U);
    EXPECT_EQ(row.trials.count(Verdict::kRight) + row.trials.count(Verdict::kWrong), 0U);
}

} // namespace
} // namespace scanloom::lab
