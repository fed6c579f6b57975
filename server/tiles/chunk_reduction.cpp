#include "server/tiles/chunk_reduction.hpp"

#include <algorithm>

namespace scanloom::tiles {
namespace {

using grid::kChunkSide;
using mapping::LogOdds;

// Salience decreases with p up to even odds and increases beyond, so that only the highest and the lowest known cell of
// a block matter. Both are computed with integer minima and maxima, which compilers vectorise.

/// Returns numbers that order like log-odds, but with the unknown cell last instead of first.
constexpr std::uint16_t unknown_last(LogOdds cell) noexcept {
    return static_cast<std::uint16_t>(static_cast<std::uint16_t>(cell) + 0x7FFFU);
}
static_assert(unknown_last(mapping::kUnknownLogOdds) == 0xFFFF && unknown_last(-32767) == 0);

/// The highest and the lowest value of each column over some rows of a chunk.
struct ColumnRange {
    std::array<LogOdds, kChunkSide> high;
    std::array<std::uint16_t, kChunkSide> low; // as unknown_last()
};

ColumnRange reduce_rows(const LogOdds* cells, std::int32_t rows) noexcept {
    ColumnRange range;
    range.high.fill(mapping::kUnknownLogOdds);
    range.low.fill(unknown_last(mapping::kUnknownLogOdds));
    for (std::int32_t row = 0; row < rows; ++row, cells += kChunkSide) {
        for (std::size_t i = 0; i < kChunkSide; ++i) {
            range.high[i] = std::max(range.high[i], cells[i]);
            range.low[i] = std::min(range.low[i], unknown_last(cells[i]));
        }
    }
    return range;
}

// Returns the saliences of cells that are their own codes, in a form that compilers vectorise; equal to
// LayerStyle::salience.

constexpr Salience salience_of_cell(mapping::HimmCount count) noexcept { return static_cast<Salience>(count + 1); }
static_assert(salience_of_cell(mapping::kUnseenHimm) == kUnknownSalience && salience_of_cell(0) == 1);

constexpr Salience salience_of_cell(classify::CellClass cell) noexcept {
    using classify::CellClass;
    const auto when = [cell](CellClass is, int salience) { return cell == is ? salience : 0; };
    return static_cast<Salience>(when(CellClass::kOccupied, 4) | when(CellClass::kDanger, 3) |
                                 when(CellClass::kFrontier, 2) | when(CellClass::kFree, 1));
}

template <class Value>
ReducedChunk reduce_codes(const mapping::ChunkCells<Value>& cells, std::int32_t block) {
    ReducedChunk reduced;
    reduced.side = kChunkSide / block;
    auto* pixel = reduced.pixels.data();
    for (std::int32_t j = 0; j < kChunkSide; j += block) {
        std::array<Salience, kChunkSide> column{};
        for (std::int32_t row = j; row < j + block; ++row) {
            const Value* cell = &cells[static_cast<std::size_t>(row) * kChunkSide];
            for (std::size_t i = 0; i < kChunkSide; ++i) column[i] = std::max(column[i], salience_of_cell(cell[i]));
        }
        for (std::int32_t i = 0; i < kChunkSide; i += block) {
            Salience highest = kUnknownSalience;
            for (std::int32_t at = i; at < i + block; ++at)
                highest = std::max(highest, column[static_cast<std::size_t>(at)]);
            *pixel++ = highest;
        }
    }
    return reduced;
}

/// Reduces blocks of one cell.
ReducedChunk saliences_of(const mapping::ChunkCells<LogOdds>& cells) {
    const auto& salience = salience_table();
    ReducedChunk reduced;
    reduced.side = kChunkSide;
    std::ranges::transform(cells, reduced.pixels.begin(),
                           [&](LogOdds cell) { return salience[static_cast<std::uint16_t>(cell)]; });
    return reduced;
}

} // namespace

ReducedChunk reduce(const mapping::ChunkCells<mapping::HimmCount>& cells, std::int32_t block) {
    return reduce_codes(cells, block);
}

ReducedChunk reduce(const mapping::ChunkCells<classify::CellClass>& cells, std::int32_t block) {
    return reduce_codes(cells, block);
}

ReducedChunk reduce(const mapping::ChunkCells<mapping::LogOdds>& cells, std::int32_t block) {
    if (block == 1) return saliences_of(cells);
    const auto& salience = salience_table();
    ReducedChunk reduced;
    reduced.side = kChunkSide / block;
    auto* pixel = reduced.pixels.data();
    for (std::int32_t j = 0; j < kChunkSide; j += block) {
        const auto range = reduce_rows(&cells[static_cast<std::size_t>(j) * kChunkSide], block);
        for (std::int32_t i = 0; i < kChunkSide; i += block) {
            LogOdds high = mapping::kUnknownLogOdds;
            std::uint16_t low = unknown_last(mapping::kUnknownLogOdds);
            for (auto at = static_cast<std::size_t>(i); at < static_cast<std::size_t>(i + block); ++at) {
                high = std::max(high, range.high[at]);
                low = std::min(low, range.low[at]);
            }
            const auto low_bits = static_cast<std::uint16_t>(low - 0x7FFFU);
            *pixel++ = std::max(salience[static_cast<std::uint16_t>(high)], salience[low_bits]);
        }
    }
    return reduced;
}

} // namespace scanloom::tiles
