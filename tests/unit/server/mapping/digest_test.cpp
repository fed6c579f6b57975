#include "server/mapping/digest.hpp"

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

TEST(Digest, OfTwoChunksIsTheHashOfTheirDocumentedBytes) {
    OccupancyLayer layer{MapConfig{}};
    auto cells = unknown_cells();
    cells[0] = 0x0102;
    cells[4095] = -2;
    layer.restore({.cj = -1, .ci = 3}, 1, cells);
    layer.restore({.cj = -1, .ci = -258}, 2, cells);
    // Computed by Python's hashlib from struct.pack('<ii4096h', ci, cj, *cells), (-258, -1) first.
    EXPECT_EQ(digest_of(layer.snapshot()), "a965e4481f9038685fc253d238380f7ce51e4bdcaaed45a95c1553de7ee282ff");
}

TEST(Digest, OfNothingIsTheHashOfNoBytes) {
    OccupancyLayer layer{MapConfig{}};
    EXPECT_EQ(digest_of(layer.snapshot()), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Digest, DependsNeitherOnTheOrderNorOnTheRevisionsNorOnBlankChunks) {
    std::mt19937 random(7);
    std::vector<std::pair<grid::ChunkKey, Cells>> chunks;
    for (std::int32_t n = 0; n < 40; ++n) chunks.push_back({{n % 9 - 4, n * 37 % 101 - 50}, random_cells(random)});

    OccupancyLayer first{MapConfig{}};
    Revision revision = 0;
    for (const auto& [key, cells] : chunks) first.restore(key, ++revision, cells);

    OccupancyLayer second{MapConfig{}};
    second.restore({.cj = 1000, .ci = -1000}, 1, unknown_cells());
    std::shuffle(chunks.begin(), chunks.end(), random);
    for (const auto& [key, cells] : chunks) {
        second.restore(key, 500, cells);
        static_cast<void>(second.snapshot());
    }
    EXPECT_EQ(digest_of(first.snapshot()), digest_of(second.snapshot()));
}

TEST(Digest, ChangesWithAnyCellAndWithThePlaceOfAChunk) {
    std::mt19937 random(8);
    auto cells = random_cells(random);
    const auto digest_at = [&](grid::ChunkKey key) {
        OccupancyLayer layer{MapConfig{}};
        layer.restore(key, 1, cells);
        return digest_of(layer.snapshot());
    };
    const auto before = digest_at({2, 3});
    EXPECT_NE(before, digest_at({3, 2}));
    cells[1234] = static_cast<LogOdds>(cells[1234] + 1);
    EXPECT_NE(before, digest_at({2, 3}));
}

} // namespace
} // namespace scanloom::mapping
