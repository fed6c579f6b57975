#pragma once

namespace scanloom::classify {

/// Decides from a cell's value whether it is free or occupied, without flickering: between two limits it stays what
/// it was. Folded scan by scan, as what it was counts.
///
/// Value  what a layer holds for a cell: the greater, the more it is occupied.
/// Pre    free < occupied, first_free <= free.
/// Source  section 6 of the design models.
template <class Value>
struct Hysteresis {
    Value occupied;   ///< from here it is occupied
    Value free;       ///< down from here it is free
    Value first_free; ///< the same for a cell that is unexplored yet: as clear evidence as that is needed
    Value unseen;     ///< marks a cell without a value: it stays what it is
};

} // namespace scanloom::classify
