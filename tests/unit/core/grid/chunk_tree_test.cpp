#include "core/grid/chunk_tree.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <thread>

namespace scanloom::grid {
namespace {

using TestChunk = Chunk<std::int16_t>;
using Keys = std::set<ChunkKey>;

std::shared_ptr<const TestChunk> blank() {
    TestChunk chunk;
    chunk.cells.fill(-1);
    return std::make_shared<const TestChunk>(chunk);
}

Keys visited(const ChunkView<TestChunk>& view, const ChunkBox& box = {}, Revision since = 0) {
    Keys keys;
    view.visit(box, since, [&](ChunkKey key, const TestChunk&) {
        EXPECT_TRUE(keys.insert(key).second) << "chunk " << key.ci << ", " << key.cj << " visited twice";
    });
    return keys;
}

ChunkKey random_key(std::mt19937& random) {
    const int reach = 1 << (random() % 25);
    std::uniform_int_distribution<std::int32_t> coordinate(-reach, reach - 1);
    return {coordinate(random), coordinate(random)};
}

TEST(ChunkTree, StoresChunksAnywhereAroundTheOrigin) {
    ChunkTree<TestChunk> tree(blank());
    std::map<ChunkKey, std::int16_t> written;
    std::mt19937 random(3);
    for (std::int16_t n = 0; n < 3000; ++n) {
        const ChunkKey key = random_key(random);
        tree.write(key, static_cast<Revision>(n) + 1).cells[17] = n;
        written[key] = n;
    }
    const auto view = tree.snapshot();
    for (const auto& [key, value] : written) {
        const auto* chunk = view.find(key);
        ASSERT_NE(chunk, nullptr);
        EXPECT_EQ(chunk->cells[17], value);
        EXPECT_EQ(chunk->cells[18], -1);
        EXPECT_EQ(chunk->revision, static_cast<Revision>(value) + 1);
    }
    EXPECT_EQ(visited(view).size(), written.size());
    EXPECT_EQ(view.find({1 << 26, 3}), nullptr);
}

TEST(ChunkTree, AcceptsExtremeKeys) {
    ChunkTree<TestChunk> tree(blank());
    const auto low = std::numeric_limits<std::int32_t>::min();
    const auto high = std::numeric_limits<std::int32_t>::max();
    const Keys keys = {{low, low}, {low, high}, {high, low}, {high, high}, {0, 0}, {-1, -1}};
    for (const auto& key : keys) tree.write(key, 1).cells[0] = 1;
    EXPECT_EQ(visited(tree.snapshot()), keys);
}

TEST(ChunkTree, CountsCopiesOfChunksSharedWithASnapshot) {
    ChunkTree<TestChunk> tree(blank());
    for (const std::int32_t ci : {0, 1, 2, 100}) (void)tree.write({0, ci}, 1);
    EXPECT_EQ(tree.copied(), 0U) << "no snapshot exists";
    auto view = tree.snapshot();
    EXPECT_EQ(tree.copied(), 0U);
    (void)tree.write({0, 1}, 2);
    (void)tree.write({0, 1}, 3);
    (void)tree.write({0, 100}, 3);
    (void)tree.write({5, 5}, 3);
    EXPECT_EQ(tree.copied(), 2U) << "each chunk is copied once, new chunks are not copied";
    view = tree.snapshot();
    EXPECT_EQ(tree.copied(), 0U);
}

TEST(ChunkTree, WritesInPlaceAfterTheLastSnapshotIsReleased) {
    ChunkTree<TestChunk> tree(blank());
    const TestChunk* first = &tree.write({0, 0}, 1);
    (void)tree.write({100, 100}, 1); // a new root above both chunks
    {
        const auto view = tree.snapshot();
        EXPECT_EQ(view.find({0, 0}), first);
    }
    EXPECT_EQ(&tree.write({0, 0}, 2), first);
    EXPECT_EQ(tree.copied(), 0U);
    const auto view = tree.snapshot();
    const auto of_a_reader = view;
    EXPECT_NE(&tree.write({0, 0}, 3), first) << "the snapshot still exists";
    EXPECT_EQ(tree.copied(), 1U);
    EXPECT_EQ(of_a_reader.find({0, 0}), first);
}

TEST(ChunkTree, CopiesChunksStillSharedWithAnOlderSnapshot) {
    ChunkTree<TestChunk> tree(blank());
    tree.write({0, 0}, 1).cells[0] = 1;
    tree.write({0, 1}, 1).cells[0] = 1;
    const auto old = tree.snapshot();
    tree.write({0, 0}, 2).cells[0] = 2;
    { const auto gone = tree.snapshot(); }
    tree.write({0, 0}, 3).cells[0] = 3; // the old snapshot does not share this copy
    EXPECT_EQ(tree.copied(), 0U);
    tree.write({0, 1}, 3).cells[0] = 3;
    EXPECT_EQ(tree.copied(), 1U);
    EXPECT_EQ(old.find({0, 0})->cells[0], 1);
    EXPECT_EQ(old.find({0, 1})->cells[0], 1);
}

TEST(ChunkTree, BranchesAreIndependent) {
    ChunkTree<TestChunk> tree(blank());
    tree.write({0, 0}, 1).cells[0] = 1;
    tree.write({0, 1}, 1).cells[0] = 1;
    auto branch = tree.branch();
    tree.write({0, 0}, 2).cells[0] = 2;
    branch.write({0, 1}, 2).cells[0] = 3;
    EXPECT_EQ(branch.find({0, 0})->cells[0], 1);
    EXPECT_EQ(tree.find({0, 1})->cells[0], 1);
    EXPECT_EQ(tree.copied(), 1U);
    EXPECT_EQ(branch.copied(), 1U);
    EXPECT_EQ(branch.size(), 2U);
}

TEST(ChunkTree, ConcurrentReadersSeeConsistentSnapshots) {
    ChunkTree<TestChunk> tree(blank());
    std::mutex mutex;
    std::optional<ChunkView<TestChunk>> published;
    std::atomic<bool> done = false;
    const auto look = [&] {
        std::int16_t newest = -1;
        while (!done) {
            std::optional<ChunkView<TestChunk>> view;
            {
                const std::lock_guard lock(mutex);
                view = published;
            }
            if (!view) continue; // not published at the moment
            const std::int16_t version = view->find({0, 0})->cells[0];
            EXPECT_GE(version, newest) << "versions increase";
            newest = version;
            view->visit({}, 0, [&](ChunkKey, const TestChunk& chunk) {
                for (const std::int16_t cell : chunk.cells) ASSERT_EQ(cell, version);
            });
        }
    };
    std::thread one(look);
    std::thread other(look);
    for (std::int16_t version = 0; version < 2000; ++version) {
        {
            const std::lock_guard lock(mutex);
            published.reset();
        }
        for (std::int32_t ci = -2; ci < 2; ++ci) {
            tree.write({0, ci}, static_cast<Revision>(version) + 1).cells.fill(version);
        }
        const std::lock_guard lock(mutex);
        published = tree.snapshot();
    }
    done = true;
    one.join();
    other.join();
}

TEST(ChunkTree, SnapshotsNeverChange) {
    ChunkTree<TestChunk> tree(blank());
    tree.write({0, 0}, 1).cells[0] = 10;
    tree.write({5, -3}, 1).cells[0] = 11;
    const auto before = tree.snapshot();
    tree.write({0, 0}, 2).cells[0] = 20;
    tree.write({1000, 1000}, 2).cells[0] = 21;
    const auto after = tree.snapshot();
    EXPECT_EQ(before.find({0, 0})->cells[0], 10);
    EXPECT_EQ(before.find({1000, 1000}), nullptr);
    EXPECT_EQ(after.find({0, 0})->cells[0], 20);
    EXPECT_EQ(before.find({5, -3}), after.find({5, -3})) << "unchanged chunks are shared";
}

TEST(ChunkTree, VisitsExactlyTheChunksInABoxChangedSinceARevision) {
    std::mt19937 random(4);
    for (int round = 0; round < 50; ++round) {
        ChunkTree<TestChunk> tree(blank());
        std::map<ChunkKey, Revision> revisions;
        for (Revision revision = 1; revision <= 200; ++revision) {
            const ChunkKey key{static_cast<std::int32_t>(random() % 60) - 30,
                               static_cast<std::int32_t>(random() % 60) - 30};
            (void)tree.write(key, revision);
            revisions[key] = revision;
        }
        const auto view = tree.snapshot();
        const std::int64_t ci = static_cast<std::int64_t>(random() % 60) - 30;
        const std::int64_t cj = static_cast<std::int64_t>(random() % 60) - 30;
        const ChunkBox box{ci, cj, ci + static_cast<std::int64_t>(random() % 40),
                           cj + static_cast<std::int64_t>(random() % 40)};
        const Revision since = random() % 200;
        Keys expected;
        Revision newest = 0;
        for (const auto& [key, revision] : revisions) {
            if (key.ci < box.ci_begin || key.ci >= box.ci_end || key.cj < box.cj_begin || key.cj >= box.cj_end)
                continue;
            newest = std::max(newest, revision);
            if (revision > since) expected.insert(key);
        }
        EXPECT_EQ(visited(view, box, since), expected);
        EXPECT_EQ(view.newest(box), newest);
    }
}

TEST(ChunkTree, NewestRevisionSurvivesRestoringOlderChunks) {
    ChunkTree<TestChunk> tree(blank());
    (void)tree.write({0, 0}, 9);
    (void)tree.write({0, 1}, 4);
    EXPECT_EQ(tree.snapshot().newest({}), 9U);
}

} // namespace
} // namespace scanloom::grid
