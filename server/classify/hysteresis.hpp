#pragma once

namespace scanloom::classify {

/// Limits that decide from a cell's value whether it is free or occupied, without flickering: between the two limits a
/// cell keeps its type. Must be applied scan by scan, because the result depends on the previous type.
///
/// `Value` is the type of a layer's cells; a greater value means more evidence that a cell is occupied.
/// Precondition: free < occupied, first_free <= free.
/// Source: section 6 of the design models.
template <class Value>
struct Hysteresis {
    Value occupied;   ///< a cell is occupied at this value or above
    Value free;       ///< a cell is free at this value or below
    Value first_free; ///< like `free`, for an unexplored cell, which needs clearer evidence
    Value unseen;     ///< marks a cell without a value; its type does not change
};

} // namespace scanloom::classify
