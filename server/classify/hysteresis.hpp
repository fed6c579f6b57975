#pragma once

#include "server/classify/cell_class.hpp"

#include <cassert>
#include <cstddef>
#include <span>

namespace scanloom::classify {

/// Decides from a cell's value whether it is free or occupied, without flickering: between two thresholds it stays what
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

    [[nodiscard]] OccType operator()(OccType before, Value value) const noexcept {
        if (value == unseen) return before;
        if (value >= occupied) return OccType::kOccupied;
        const Value limit = before == OccType::kUnexplored ? first_free : free;
        return value <= limit ? OccType::kFree : before;
    }

    /// Brings the types of some cells up to date. @return whether any of them changed.
    bool fold(std::span<const Value> values, std::span<OccType> types) const noexcept {
        assert(values.size() == types.size());
        bool changed = false;
        for (std::size_t n = 0; n < values.size(); ++n) {
            const OccType after = (*this)(types[n], values[n]);
            changed |= after != types[n];
            types[n] = after;
        }
        return changed;
    }
};

} // namespace scanloom::classify
