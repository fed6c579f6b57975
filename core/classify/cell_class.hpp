#pragma once

#include "core/grid/chunk.hpp"
#include "core/grid/chunk_tree.hpp"

#include <cstdint>

namespace scanloom::classify {

/// The type of a cell according to the evidence so far. Depends on the order of the evidence: see Hysteresis.
enum class OccType : std::uint8_t { kUnexplored = 0, kFree = 1, kOccupied = 2 };

/// The OccTypes of one chunk's cells. No cell is both free and occupied.
struct OccPlanes {
    grid::BitPlane free{};     ///< set: the cell is free
    grid::BitPlane occupied{}; ///< set: the cell is occupied

    /// Returns the type of a cell of the chunk.
    [[nodiscard]] OccType at(grid::Cell cell) const noexcept {
        const auto is_set = [&](const grid::BitPlane& plane) { return grid::is_set(plane, cell); };
        return is_set(free) ? OccType::kFree : is_set(occupied) ? OccType::kOccupied : OccType::kUnexplored;
    }

    /// Sets the type of a cell of the chunk.
    void set(grid::Cell cell, OccType type) noexcept {
        grid::set(free, cell, type == OccType::kFree);
        grid::set(occupied, cell, type == OccType::kOccupied);
    }
};

/// The meaning of a cell for navigation: its OccType, refined by its neighbours. Tiles use the same numbers.
///   frontier  unexplored, and one of the 8 cells around it is free
///   danger    free, and an occupied cell is near: see ClassLayer
enum class CellClass : std::uint8_t { kUnexplored = 0, kFree = 1, kOccupied = 2, kFrontier = 3, kDanger = 4 };

/// The classes of one chunk's cells.
using ClassChunk = grid::Chunk<CellClass>;
/// The classes of all cells at one moment.
using ClassView = grid::ChunkView<ClassChunk>;

/// Returns the class of a cell; kUnexplored if its chunk does not exist.
[[nodiscard]] inline CellClass class_at(const ClassView& view, grid::Cell cell) noexcept {
    const auto* chunk = view.find(grid::chunk_of(cell));
    return chunk == nullptr ? CellClass::kUnexplored : chunk->at(cell);
}

/// Limits that decide from a cell's value whether it is free or occupied, without flickering: between the two limits a
/// cell keeps its type. Must be applied scan by scan, because the result depends on the previous type.
///
/// `Value` is the type of a layer's cells; a greater value means more evidence that a cell is occupied.
/// Precondition: free < occupied, first_free <= free.
template <class Value>
struct Hysteresis {
    Value occupied;   ///< a cell is occupied at this value or above
    Value free;       ///< a cell is free at this value or below
    Value first_free; ///< like `free`, for an unexplored cell, which needs clearer evidence
    Value unseen;     ///< marks a cell without a value; its type does not change
};

} // namespace scanloom::classify
