#include "core/classify/class_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <vector>

namespace scanloom::classify {
namespace {

using grid::Cell;
using grid::ChunkKey;

/// OccTypes of any cells, and the keys of the chunks changed since the last update.
class Types {
public:
    void set(Cell cell, OccType type) {
        const ChunkKey key = grid::chunk_of(cell);
        auto& plane = planes_[key];
        if (!plane) plane = std::make_unique<OccPlanes>();
        plane->set(cell, type);
        if (std::ranges::find(changed_, key) == changed_.end()) changed_.push_back(key);
    }

    [[nodiscard]] OccType at(Cell cell) const {
        const OccPlanes* planes = find(grid::chunk_of(cell));
        return planes == nullptr ? OccType::kUnexplored : planes->at(cell);
    }

    [[nodiscard]] const OccPlanes* find(ChunkKey key) const {
        const auto found = planes_.find(key);
        return found == planes_.end() ? nullptr : found->second.get();
    }

    /// Updates the layer with all changes since the previous call.
    void update(ClassLayer& layer, Revision revision) {
        layer.update(
            changed_, [this](ChunkKey key) { return find(key); }, revision);
        changed_.clear();
    }

    [[nodiscard]] std::vector<ChunkKey> keys() const {
        std::vector<ChunkKey> keys;
        for (const auto& [key, plane] : planes_) keys.push_back(key);
        return keys;
    }

private:
    std::map<ChunkKey, std::unique_ptr<OccPlanes>> planes_;
    std::vector<ChunkKey> changed_;
};

/// Computes a cell's class directly from the definition.
CellClass defined_class(const Types& types, Cell cell, int danger_cells) {
    const auto any_near = [&](OccType type, int reach) {
        for (int dj = -reach; dj <= reach; ++dj) {
            for (int di = -reach; di <= reach; ++di) {
                if ((di != 0 || dj != 0) && types.at({cell.i + di, cell.j + dj}) == type) return true;
            }
        }
        return false;
    };
    switch (types.at(cell)) {
    case OccType::kUnexplored: return any_near(OccType::kFree, 1) ? CellClass::kFrontier : CellClass::kUnexplored;
    case OccType::kFree: return any_near(OccType::kOccupied, danger_cells) ? CellClass::kDanger : CellClass::kFree;
    case OccType::kOccupied: return CellClass::kOccupied;
    }
    return CellClass::kUnexplored;
}

/// Compares the cells of [begin, end) x [begin, end), every `stride`th along each axis.
void expect_defined_classes(const Types& types, const ClassView& view, int danger_cells, int begin, int end,
                            int stride = 1) {
    for (int j = begin; j < end; j += stride) {
        for (int i = begin; i < end; i += stride) {
            ASSERT_EQ(class_at(view, {i, j}), defined_class(types, {i, j}, danger_cells))
                << "cell " << i << ", " << j << ", danger_cells " << danger_cells;
        }
    }
}

/// Sets patches of free ground with obstacles on both sides of the origin.
void scatter(Types& types, std::mt19937& random, int patches, int reach, int obstacles_in_1000) {
    for (int patch = 0; patch < patches; ++patch) {
        const auto coordinate = [&] { return static_cast<int>(random() % static_cast<unsigned>(2 * reach)) - reach; };
        const Cell corner{coordinate(), coordinate()};
        const int width = 1 + static_cast<int>(random() % 40);
        const int height = 1 + static_cast<int>(random() % 40);
        const bool cleared = random() % 8 == 0;
        for (int j = corner.j; j < std::min(corner.j + height, reach); ++j) {
            for (int i = corner.i; i < std::min(corner.i + width, reach); ++i) {
                const bool obstacle = static_cast<int>(random() % 1000) < obstacles_in_1000;
                types.set({i, j}, cleared ? OccType::kUnexplored : obstacle ? OccType::kOccupied : OccType::kFree);
            }
        }
    }
}

class ClassLayerOf : public testing::TestWithParam<int> {};

TEST_P(ClassLayerOf, EveryCellMatchesTheDefinition) {
    const int danger_cells = GetParam();
    std::mt19937 random(static_cast<unsigned>(danger_cells));
    ClassLayer layer(danger_cells);
    Types types;
    scatter(types, random, 60, 130, danger_cells > 8 ? 1 : 20);
    types.update(layer, 1);
    expect_defined_classes(types, layer.snapshot(), danger_cells, -195, 195, danger_cells > 8 ? 7 : 1);
}

TEST_P(ClassLayerOf, DangerEndsExactlyAtItsRadiusInEveryDirection) {
    const int danger_cells = GetParam();
    for (const Cell obstacle : {Cell{0, 0}, Cell{-1, -1}, Cell{63, 63}, Cell{31, -40}, Cell{-64, 0}}) {
        ClassLayer layer(danger_cells);
        Types types;
        for (int j = -140; j < 140; ++j) {
            for (int i = -140; i < 140; ++i) types.set({i, j}, OccType::kFree);
        }
        types.set(obstacle, OccType::kOccupied);
        types.update(layer, 1);
        const auto view = layer.snapshot();
        for (int j = -140; j < 140; ++j) {
            for (int i = -140; i < 140; ++i) {
                const int distance = std::max(std::abs(i - obstacle.i), std::abs(j - obstacle.j));
                const auto expected = distance == 0              ? CellClass::kOccupied
                                      : distance <= danger_cells ? CellClass::kDanger
                                                                 : CellClass::kFree;
                ASSERT_EQ(class_at(view, {i, j}), expected) << "cell " << i << ", " << j;
            }
        }
    }
}

TEST_P(ClassLayerOf, IncrementalUpdatesMatchAFreshLayer) {
    const int danger_cells = GetParam();
    std::mt19937 random(100 + static_cast<unsigned>(danger_cells));
    ClassLayer layer(danger_cells);
    Types types;
    for (Revision revision = 1; revision <= 60; ++revision) {
        scatter(types, random, static_cast<int>(random() % 4), 130, 3);
        types.update(layer, revision);
        if (revision % 3 == 0) (void)layer.snapshot(); // so that some writes copy their chunks
        if (revision % 10 != 0) continue;
        ClassLayer fresh(danger_cells);
        fresh.update(
            types.keys(), [&](ChunkKey key) { return types.find(key); }, revision);
        const auto grown = layer.snapshot();
        const auto expected = fresh.snapshot();
        for (int cj = -4; cj < 4; ++cj) {
            for (int ci = -4; ci < 4; ++ci) {
                for (int cell = 0; cell < 64 * 64; ++cell) {
                    const Cell at{64 * ci + cell % 64, 64 * cj + cell / 64};
                    ASSERT_EQ(class_at(grown, at), class_at(expected, at)) << "cell " << at.i << ", " << at.j;
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(DangerCells, ClassLayerOf, testing::Values(1, 2, 3, 4, 7, 8, 31, 32, 33, 62, 63, 64));

TEST(ClassLayer, CreatesClassChunkForFrontierNextToAFreeChunk) {
    for (const Cell corner : {Cell{0, 0}, Cell{63, 63}, Cell{-1, 0}, Cell{-64, -64}}) {
        ClassLayer layer(3);
        Types types;
        types.set(corner, OccType::kFree);
        types.update(layer, 1);
        const auto view = layer.snapshot();
        for (int dj = -1; dj <= 1; ++dj) {
            for (int di = -1; di <= 1; ++di) {
                EXPECT_EQ(class_at(view, {corner.i + di, corner.j + dj}),
                          di == 0 && dj == 0 ? CellClass::kFree : CellClass::kFrontier);
            }
        }
        EXPECT_EQ(layer.chunk_count(), 4U) << "the cell's chunk and the three chunks around its corner";
    }
}

TEST(ClassLayer, SingleObstacleCreatesNoNeighbourChunk) {
    ClassLayer layer(64);
    Types types;
    types.set({0, 0}, OccType::kOccupied);
    types.update(layer, 1);
    EXPECT_EQ(layer.chunk_count(), 1U);
    EXPECT_EQ(class_at(layer.snapshot(), {0, 0}), CellClass::kOccupied);
}

TEST(ClassLayer, UnexploredChunkIsNotCreated) {
    ClassLayer layer(3);
    Types types;
    types.set({5, 5}, OccType::kUnexplored);
    types.update(layer, 1);
    EXPECT_EQ(layer.chunk_count(), 0U);
    layer.update(
        std::vector<ChunkKey>{{7, 7}}, [](ChunkKey) { return nullptr; }, 2);
    EXPECT_EQ(layer.chunk_count(), 0U);
}

TEST(ClassLayer, ChunkRevisionIsThatOfItsLastClassChange) {
    std::mt19937 random(9);
    ClassLayer layer(5);
    Types types;
    ClassView before = layer.snapshot();
    for (Revision revision = 1; revision <= 150; ++revision) {
        scatter(types, random, static_cast<int>(random() % 2), 130, 10);
        if (random() % 3 == 0) types.set({static_cast<int>(random() % 100), 3}, OccType::kOccupied);
        types.update(layer, revision);
        const auto after = layer.snapshot();
        for (int cj = -4; cj < 4; ++cj) {
            for (int ci = -4; ci < 4; ++ci) {
                const auto* old_chunk = before.find({cj, ci});
                const auto* new_chunk = after.find({cj, ci});
                if (new_chunk == nullptr) continue;
                const bool changed = old_chunk == nullptr || old_chunk->cells != new_chunk->cells;
                const Revision expected = changed ? revision : old_chunk->revision;
                ASSERT_EQ(new_chunk->revision, expected) << "chunk " << ci << ", " << cj;
            }
        }
        before = after;
    }
}

TEST(ClassLayer, UpdateReadsOnlyTheListedChunks) {
    ClassLayer layer(64);
    Types types;
    for (int i = -200; i < 200; ++i) types.set({i, i}, OccType::kFree);
    types.update(layer, 1);
    types.set({1, 0}, OccType::kOccupied);
    std::vector<ChunkKey> requested;
    const auto find = [&](ChunkKey key) {
        requested.push_back(key);
        return types.find(key);
    };
    layer.update(std::vector<ChunkKey>{{0, 0}}, find, 2);
    EXPECT_EQ(requested, (std::vector<ChunkKey>{{0, 0}}));
    expect_defined_classes(types, layer.snapshot(), 64, -80, 80, 3);
}

TEST(ClassLayer, AcceptsChunksAtIntegerLimits) {
    const auto low = std::numeric_limits<std::int32_t>::min();
    const auto high = std::numeric_limits<std::int32_t>::max();
    OccPlanes all_free;
    all_free.free.fill(~std::uint64_t{0});
    for (const ChunkKey corner : {ChunkKey{low, low}, {low, high}, {high, low}, {high, high}}) {
        ClassLayer layer(64);
        layer.update(
            std::vector<ChunkKey>{corner}, [&](ChunkKey) { return &all_free; }, 1);
        const auto view = layer.snapshot();
        std::size_t at_this_end = 0;
        view.visit({}, 0, [&](ChunkKey key, const ClassChunk& chunk) {
            const bool is_near =
                std::abs(std::int64_t{key.ci} - corner.ci) <= 1 && std::abs(std::int64_t{key.cj} - corner.cj) <= 1;
            at_this_end += is_near ? 1 : 0;
            const auto expected = key == corner ? CellClass::kFree : CellClass::kFrontier;
            EXPECT_NE(std::ranges::find(chunk.cells, expected), chunk.cells.end());
        });
        EXPECT_EQ(at_this_end, 4U) << "the chunk and three neighbours with frontier cells at the border";
        EXPECT_EQ(layer.chunk_count(), 4U) << "no chunk at the opposite end";
    }
}

TEST(ClassLayer, RemovingAChunksTypesRemovesItsClasses) {
    ClassLayer layer(3);
    Types types;
    types.set({0, 0}, OccType::kFree);
    types.update(layer, 1);
    layer.update(
        std::vector<ChunkKey>{{0, 0}}, [](ChunkKey) { return nullptr; }, 2);
    const auto view = layer.snapshot();
    for (int j = -2; j < 2; ++j) {
        for (int i = -2; i < 2; ++i) EXPECT_EQ(class_at(view, {i, j}), CellClass::kUnexplored);
    }
    EXPECT_EQ(view.find({-1, -1})->revision, 2U);
}

} // namespace
} // namespace scanloom::classify
