#include "core/mapping/snapshot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scanloom::mapping {
namespace {

using Cells = std::array<LogOdds, std::size_t{grid::kChunkSide} * grid::kChunkSide>;

Cells unknown_cells() {
    Cells cells;
    cells.fill(kUnknownLogOdds);
    return cells;
}

Cells random_cells(std::mt19937& random) {
    Cells cells;
    for (auto& cell : cells) cell = static_cast<LogOdds>(static_cast<int>(random() % 20000) - 10000);
    return cells;
}

std::string digest_of_occupancy(LaserLayers& layers) {
    return digest_of(Snapshot{.laser = layers.snapshot()}, Layer::kOccupancy);
}

TEST(Digest, OfTwoChunksIsTheHashOfTheDocumentedBytes) {
    LaserLayers layers{MapConfig{}};
    auto cells = unknown_cells();
    cells[0] = 0x0102;
    cells[4095] = -2;
    layers.restore({.cj = -1, .ci = 3}, 1).occupancy = cells;
    layers.restore({.cj = -1, .ci = -258}, 2).occupancy = cells;
    // Computed with Python's hashlib from struct.pack('<d', 0.05), followed by struct.pack('<ii4096h', ci, cj, *cells)
    // of each chunk, beginning with chunk (-258, -1).
    EXPECT_EQ(digest_of_occupancy(layers), "9bde9bfd28e31e3326fa675f9644ee1f0123ab2e39576730471dab72ff175682");
}

TEST(Digest, OfAnEmptyMapIsTheHashOfTheCellSize) {
    LaserLayers layers{MapConfig{}};
    EXPECT_EQ(digest_of_occupancy(layers), "7f925b2036e92fe2f1f0697c3aedfff74d719c1ee2cb6b739d7c30484e75972c");
}

TEST(Digest, DependsOnTheCellSize) {
    LaserLayers layers{MapConfig{}};
    layers.restore({.cj = 0, .ci = 0}, 1).occupancy.fill(100);
    MapConfig larger;
    larger.cell_size = 0.1;
    EXPECT_NE(digest_of_occupancy(layers),
              digest_of(Snapshot{.config = larger, .laser = layers.snapshot()}, Layer::kOccupancy));
}

TEST(Digest, IgnoresOrderRevisionsAndBlankChunks) {
    std::mt19937 random(7);
    std::vector<std::pair<grid::ChunkKey, Cells>> chunks;
    for (std::int32_t n = 0; n < 40; ++n) chunks.push_back({{n % 9 - 4, n * 37 % 101 - 50}, random_cells(random)});

    LaserLayers first{MapConfig{}};
    Revision revision = 0;
    for (const auto& [key, cells] : chunks) first.restore(key, ++revision).occupancy = cells;

    LaserLayers second{MapConfig{}};
    second.restore({.cj = 1000, .ci = -1000}, 1).occupancy = unknown_cells();
    std::shuffle(chunks.begin(), chunks.end(), random);
    for (const auto& [key, cells] : chunks) {
        second.restore(key, 500).occupancy = cells;
        static_cast<void>(second.snapshot());
    }
    EXPECT_EQ(digest_of_occupancy(first), digest_of_occupancy(second));
}

} // namespace
} // namespace scanloom::mapping
