#include "core/mapping/trajectory.hpp"

#include <gtest/gtest.h>

#include <mutex>
#include <thread>
#include <vector>

namespace scanloom::mapping {
namespace {

constexpr std::size_t kMostKept = kTrajectoryKept + 2 * kListBlock; // points

TrajectoryPoint point(std::size_t n) {
    return {2 * n + 1, static_cast<double>(n) / 10, {static_cast<double>(n), 0.5, 0.25}};
}

void append(Trajectory& trajectory, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n) trajectory.append(point(n));
}

void expect_newest(const TrajectoryView& view, std::size_t size) {
    ASSERT_EQ(view.size(), size);
    for (std::size_t n = view.begin(); n < size; ++n) ASSERT_EQ(view[n], point(n));
}

TEST(Trajectory, KeepsOnlyTheNewestPoints) {
    Trajectory trajectory;
    std::vector<TrajectoryView> views;
    for (std::size_t n = 0; n < 3 * kTrajectoryKept; ++n) {
        trajectory.append(point(n));
        const auto view = trajectory.snapshot();
        ASSERT_EQ(view.size(), n + 1);
        ASSERT_GE(view.size() - view.begin(), std::min(n + 1, kTrajectoryKept));
        ASSERT_LE(view.size() - view.begin(), kMostKept);
        ASSERT_LE(trajectory.block_count() * kListBlock, kMostKept);
        if (n % 1000 == 0) views.push_back(view);
    }
    for (std::size_t n = 0; n < views.size(); ++n) expect_newest(views[n], 1000 * n + 1); // unchanged views
}

TEST(Trajectory, FindsTheFirstKeptPointAfterARevision) {
    Trajectory trajectory;
    append(trajectory, 0, 2 * kTrajectoryKept);
    const auto view = trajectory.snapshot();
    ASSERT_GT(view.begin(), 0U);
    for (Revision since = 0; since < 4 * kTrajectoryKept + 3; since += 7) {
        std::size_t first = view.begin();
        while (first < view.size() && view[first].revision <= since) ++first;
        ASSERT_EQ(view.first_after(since), first) << since;
    }
}

TEST(Trajectory, ContinuesAfterPointsThatItNeverStored) {
    constexpr std::size_t kBefore = 1'234'567;
    Trajectory trajectory(kBefore);
    EXPECT_EQ(trajectory.snapshot().begin(), kBefore);
    EXPECT_EQ(trajectory.snapshot().size(), kBefore);
    EXPECT_EQ(trajectory.snapshot().first_after(0), kBefore);
    EXPECT_EQ(trajectory.block_count(), 0U);
    append(trajectory, kBefore, kBefore + 700);
    EXPECT_EQ(trajectory.snapshot().begin(), kBefore);
    expect_newest(trajectory.snapshot(), kBefore + 700);
}

TEST(Trajectory, BranchesGrowIndependently) {
    for (const std::size_t before : {std::size_t{0}, std::size_t{100}, kListBlock, kTrajectoryKept + 700}) {
        Trajectory first(before / 2);
        append(first, before / 2, before);
        Trajectory second = first.branch();
        append(second, before, before + 10);
        expect_newest(second.snapshot(), before + 10);
        append(second, before + 10, before + 2 * kTrajectoryKept);
        for (std::size_t n = before; n < before + 600; ++n) first.append({});
        expect_newest(second.snapshot(), before + 2 * kTrajectoryKept);
        const auto view = first.snapshot();
        ASSERT_EQ(view.size(), before + 600);
        for (std::size_t n = view.begin(); n < view.size(); ++n) {
            ASSERT_EQ(view[n], n < before ? point(n) : TrajectoryPoint{});
        }
    }
}

// ThreadSanitizer checks in this test that readers and branches share data with the writer safely.
TEST(Trajectory, GrowsWhileReadersAndBranchesUseIt) {
    constexpr std::size_t kPoints = 2 * kTrajectoryKept;
    Trajectory trajectory;
    std::mutex mutex;
    TrajectoryView newest;
    std::thread reader([&] {
        for (std::size_t size = 0; size < kPoints;) {
            TrajectoryView view;
            {
                const std::lock_guard lock(mutex);
                view = newest;
            }
            size = view.size();
            expect_newest(view, size);
        }
    });
    std::vector<std::thread> branches;
    for (std::size_t n = 0; n < kPoints; ++n) {
        trajectory.append(point(n));
        const std::lock_guard lock(mutex);
        newest = trajectory.snapshot();
        if (n % 3001 != 0) continue;
        branches.emplace_back([branch = trajectory.branch(), n]() mutable {
            append(branch, n + 1, n + 1000);
            expect_newest(branch.snapshot(), n + 1000);
        });
    }
    for (auto& branch : branches) branch.join();
    reader.join();
}

} // namespace
} // namespace scanloom::mapping
