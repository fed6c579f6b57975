#pragma once

#include "core/classify/cell_class.hpp"
#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/map_config.hpp"
#include "tests/support/plane.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <cmath>
#include <cstdint>

/// Computes the classes of a map by their definition, only from the evidence layers after each scan.
namespace scanloom::oracle {

using classify::CellClass;
using classify::OccType;

/// Returns whether a cell's log-odds are at or above a probability, up to the rounding to steps of 1/2048.
inline bool reaches(mapping::LogOdds l, double p) { return l + 0.5 >= 2048.0 * std::log(p / (1.0 - p)); }
inline bool falls_to(mapping::LogOdds l, double p) { return l - 0.5 <= 2048.0 * std::log(p / (1.0 - p)); }

/// UNEXPLORED until the evidence leaves the dead band, then FREE or OCCUPIED, with hysteresis.
class OccTypes {
public:
    explicit OccTypes(const mapping::MapConfig& config) : config_(config) {}

    /// Call after each scan.
    void apply(const mapping::Snapshot& snapshot) {
        testing_support::for_each_laser_cell(
            snapshot, [&](grid::Cell cell, const mapping::LaserChunk& chunk, std::size_t n) {
                const OccType before = types_.at(cell);
                const OccType after = config_.class_source == ClassSource::kHimm ? by_count(before, chunk.himm[n])
                                                                                 : by_odds(before, chunk.occupancy[n]);
                if (after == before) return;
                ++changes_;
                types_[cell] = after;
            });
    }

    [[nodiscard]] const Plane<OccType>& plane() const { return types_; }

    /// Returns how often any cell changed its type.
    [[nodiscard]] std::size_t changes() const { return changes_; }

private:
    [[nodiscard]] OccType by_odds(OccType before, mapping::LogOdds l) const {
        if (l == mapping::kUnknownLogOdds) return before;
        if (reaches(l, config_.class_p_occupied)) return OccType::kOccupied;
        return falls_to(l, config_.class_p_free) ? OccType::kFree : before;
    }

    /// A cell whose first observation is a hit counts 3, which is not evidence that it is free. So the first change to
    /// free needs a count of 0.
    [[nodiscard]] OccType by_count(OccType before, mapping::HimmCount count) const {
        if (count == mapping::kUnseenHimm) return before;
        if (count >= config_.class_himm_occupied) return OccType::kOccupied;
        const int free = before == OccType::kUnexplored ? 0 : config_.class_himm_free;
        return count <= free ? OccType::kFree : before;
    }

    mapping::MapConfig config_;
    Plane<OccType> types_{OccType::kUnexplored};
    std::size_t changes_ = 0;
};

/// Returns FRONTIER for an UNEXPLORED cell with a FREE cell among its 8 neighbours, and DANGER for a FREE cell with an
/// OCCUPIED cell at Chebyshev distance 1 .. danger_cells.
inline CellClass class_of(const Plane<OccType>& types, grid::Cell cell, std::int32_t danger_cells) {
    const auto is_near = [&](OccType type, std::int32_t reach) {
        for (std::int32_t j = cell.j - reach; j <= cell.j + reach; ++j) {
            for (std::int32_t i = cell.i - reach; i <= cell.i + reach; ++i) {
                if ((i != cell.i || j != cell.j) && types.at({i, j}) == type) return true;
            }
        }
        return false;
    };
    switch (types.at(cell)) {
    case OccType::kUnexplored: return is_near(OccType::kFree, 1) ? CellClass::kFrontier : CellClass::kUnexplored;
    case OccType::kFree: return is_near(OccType::kOccupied, danger_cells) ? CellClass::kDanger : CellClass::kFree;
    case OccType::kOccupied: return CellClass::kOccupied;
    }
    return CellClass::kUnexplored;
}

} // namespace scanloom::oracle
