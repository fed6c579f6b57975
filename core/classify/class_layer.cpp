#include "core/classify/class_layer.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>

namespace scanloom::classify {
namespace {

constexpr std::int32_t kSide = grid::kChunkSide;

const std::shared_ptr<const ClassChunk>& blank_chunk() {
    static const auto blank = [] {
        ClassChunk chunk;
        chunk.cells.fill(CellClass::kUnexplored);
        return std::make_shared<const ClassChunk>(chunk);
    }();
    return blank;
}

/// Returns the chunk `di` to the right and `dj` above, unless its index is out of range.
std::optional<grid::ChunkKey> neighbour(grid::ChunkKey key, std::int32_t di, std::int32_t dj) {
    const std::int64_t ci = std::int64_t{key.ci} + di;
    const std::int64_t cj = std::int64_t{key.cj} + dj;
    const auto numbered = [](std::int64_t c) {
        return std::numeric_limits<std::int32_t>::min() <= c && c <= std::numeric_limits<std::int32_t>::max();
    };
    if (!numbered(ci) || !numbered(cj)) return std::nullopt;
    return grid::ChunkKey{.cj = static_cast<std::int32_t>(cj), .ci = static_cast<std::int32_t>(ci)};
}

bool any(const BitPlane& plane) {
    return std::ranges::any_of(plane, [](std::uint64_t row) { return row != 0; });
}

/// Returns whether a cell of the plane is within `reach` cells of the neighbouring chunk at (di, dj).
bool touches(const BitPlane& plane, std::int32_t reach, std::int32_t di, std::int32_t dj) {
    const std::uint64_t lowest = ~std::uint64_t{0} >> (kSide - reach);
    const std::uint64_t columns = di < 0 ? lowest : di > 0 ? lowest << (kSide - reach) : ~std::uint64_t{0};
    const std::int32_t begin = dj > 0 ? kSide - reach : 0;
    const std::int32_t end = dj < 0 ? reach : kSide;
    return std::any_of(plane.begin() + begin, plane.begin() + end,
                       [columns](std::uint64_t row) { return (row & columns) != 0; });
}

/// Returns the next step of a window that grows by doubling up to `reach` cells and already covers `covered` cells more
/// than its own.
std::int32_t next_step(std::int32_t covered, std::int32_t reach) { return std::min(covered + 1, reach - covered); }

/// Returns the middle one of three adjacent rows of 64 cells, with each cell set that has a set cell within `reach`
/// columns, 1 .. 64.
std::uint64_t widened(std::uint64_t west, std::uint64_t here, std::uint64_t east, std::int32_t reach) {
    if ((west | here | east) == 0) return 0;
    std::uint64_t from_west = here;
    std::uint64_t from_east = here;
    for (std::int32_t covered = 0; covered < reach;) {
        const std::int32_t step = next_step(covered, reach);
        from_west |= from_west << step | west >> (kSide - step);
        from_east |= from_east >> step | east << (kSide - step);
        west |= west << step;
        east |= east >> step;
        covered += step;
    }
    return from_west | from_east;
}

} // namespace

struct ClassLayer::Around {
    std::array<const Planes*, 9> chunks; // by rows from the bottom; nullptr: all unexplored

    [[nodiscard]] std::uint64_t row(BitPlane Planes::*plane, std::int32_t chunk, std::int32_t j) const {
        const Planes* planes = chunks[static_cast<std::size_t>(chunk)];
        return planes == nullptr ? 0 : (planes->*plane)[static_cast<std::size_t>(j)];
    }

    /// Returns the cells of the middle chunk that have a cell of the plane within `reach` cells (Chebyshev distance,
    /// 1..64).
    [[nodiscard]] BitPlane dilated(BitPlane Planes::*plane, std::int32_t reach) const {
        std::array<std::uint64_t, std::size_t{3} * kSide> rows;
        const std::int32_t end = 2 * kSide + reach;
        for (std::int32_t r = kSide - reach; r < end; ++r) {
            const std::int32_t west = r / kSide * 3;
            const std::int32_t j = r % kSide;
            rows[static_cast<std::size_t>(r)] =
                widened(row(plane, west, j), row(plane, west + 1, j), row(plane, west + 2, j), reach);
        }
        for (std::int32_t covered = 0; covered < 2 * reach;) { // combines each row with the 2 reach rows above it
            const std::int32_t step = next_step(covered, 2 * reach);
            for (std::int32_t r = kSide - reach; r < end - step; ++r) {
                rows[static_cast<std::size_t>(r)] |= rows[static_cast<std::size_t>(r + step)];
            }
            covered += step;
        }
        BitPlane middle;
        std::copy_n(rows.begin() + (kSide - reach), kSide, middle.begin());
        return middle;
    }
};

std::size_t ClassLayer::KeyHash::operator()(grid::ChunkKey key) const noexcept {
    const std::uint64_t both =
        std::uint64_t{static_cast<std::uint32_t>(key.cj)} << 32 | static_cast<std::uint32_t>(key.ci);
    const std::uint64_t mixed = both * 0x9e3779b97f4a7c15; // Fibonacci hashing: Knuth, TAOCP 3, section 6.4
    return static_cast<std::size_t>(mixed ^ mixed >> 32);
}

const std::shared_ptr<const ClassLayer::PlanesChunk>& ClassLayer::blank_planes() {
    static const auto blank = std::make_shared<const PlanesChunk>();
    return blank;
}

ClassLayer::ClassLayer(std::int32_t danger_cells)
    : danger_cells_(danger_cells), planes_(blank_planes()), tree_(blank_chunk()) {
    assert(danger_cells >= 1);
    assert(danger_cells <= kDangerCellsMax);
}

void ClassLayer::update(std::span<const grid::ChunkKey> changed, const FindPlanes& find_planes, Revision revision) {
    StaleChunks stale;
    for (const grid::ChunkKey key : changed) take_in(key, find_planes(key), revision, stale);
    for (const auto& [key, retyped] : stale) classify(key, retyped, revision);
}

/// Records which chunks must be classified again: this one, and the neighbours near enough to a change.
void ClassLayer::take_in(grid::ChunkKey key, const OccPlanes* types, Revision revision, StaleChunks& stale) {
    static constexpr Planes kUnwritten;
    const auto* known = planes_.find(key);
    if (types == nullptr && known == nullptr) return;
    const Planes& before = known == nullptr ? kUnwritten : known->planes;
    const OccPlanes now = types == nullptr ? OccPlanes{} : *types;
    BitPlane freed{};      // cells that became free or are no longer free
    BitPlane obstructed{}; // cells that became occupied or are no longer occupied
    for (std::size_t j = 0; j < freed.size(); ++j) {
        freed[j] = now.free[j] ^ before.free[j];
        obstructed[j] = now.occupied[j] ^ before.occupied[j];
    }
    if (!any(freed) && !any(obstructed)) return;
    Planes& planes = planes_.write(key, revision).planes;
    planes.free = now.free;
    planes.occupied = now.occupied;
    for (std::int32_t dj = -1; dj <= 1; ++dj) {
        for (std::int32_t di = -1; di <= 1; ++di) {
            const auto other = neighbour(key, di, dj);
            if (other && (touches(freed, 1, di, dj) || touches(obstructed, danger_cells_, di, dj))) (void)stale[*other];
        }
    }
    BitPlane& retyped = stale[key];
    for (std::size_t j = 0; j < retyped.size(); ++j) retyped[j] |= freed[j] | obstructed[j];
}

void ClassLayer::classify(grid::ChunkKey key, const BitPlane& retyped, Revision revision) {
    static constexpr Planes kUnwritten;
    const auto* known = planes_.find(key);
    const Planes& before = known == nullptr ? kUnwritten : known->planes;
    const Around nine = around(key);
    const BitPlane beside_free = nine.dilated(&Planes::free, 1);
    const BitPlane near_occupied = nine.dilated(&Planes::occupied, danger_cells_);
    Planes now = before;
    BitPlane reclassified;
    for (std::size_t j = 0; j < reclassified.size(); ++j) {
        now.frontier[j] = beside_free[j] & ~(now.free[j] | now.occupied[j]);
        now.danger[j] = near_occupied[j] & now.free[j];
        reclassified[j] = retyped[j] | (now.frontier[j] ^ before.frontier[j]) | (now.danger[j] ^ before.danger[j]);
    }
    if (!any(reclassified)) return;
    write(key, now, reclassified, revision);
    planes_.write(key, revision).planes = now;
}

ClassLayer::Around ClassLayer::around(grid::ChunkKey key) const {
    Around nine{};
    std::size_t place = 0;
    for (std::int32_t dj = -1; dj <= 1; ++dj) {
        for (std::int32_t di = -1; di <= 1; ++di, ++place) {
            const auto other = neighbour(key, di, dj);
            if (!other) continue;
            const auto* found = planes_.find(*other);
            if (found != nullptr) nine.chunks[place] = &found->planes;
        }
    }
    return nine;
}

void ClassLayer::write(grid::ChunkKey key, const Planes& planes, const BitPlane& reclassified, Revision revision) {
    ClassChunk& chunk = tree_.write(key, revision);
    for (std::size_t j = 0; j < reclassified.size(); ++j) {
        if (reclassified[j] == 0) continue;
        CellClass* row = chunk.cells.data() + j * kSide;
        for (std::size_t i = 0; i < kSide; i += 8) {
            const auto eight = [i, j](const BitPlane& plane, CellClass value) {
                return bits::unpack8(plane[j] >> i & 0xff) * static_cast<std::uint64_t>(value);
            };
            // A danger cell is also free; no other two planes share a cell.
            const std::uint64_t bytes =
                eight(planes.free, CellClass::kFree) + eight(planes.occupied, CellClass::kOccupied) +
                eight(planes.frontier, CellClass::kFrontier) +
                bits::unpack8(planes.danger[j] >> i & 0xff) *
                    (static_cast<std::uint64_t>(CellClass::kDanger) - static_cast<std::uint64_t>(CellClass::kFree));
            std::memcpy(row + i, &bytes, sizeof bytes);
        }
    }
}

} // namespace scanloom::classify
