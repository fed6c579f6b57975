#include "server/mapping/snapshot.hpp"

namespace scanloom::mapping {

grid::CellBox bounds_of(const Snapshot& snapshot, Layer layer) noexcept {
    const auto& [laser, sonar] = snapshot.bounds;
    switch (layer) {
    case Layer::kOccupancy: return laser.occupancy;
    case Layer::kHimm: return laser.himm;
    case Layer::kSonar: return sonar;
    case Layer::kClassification: break;
    }
    grid::CellBox seen = snapshot.config.class_source == ClassSource::kHimm ? laser.himm : laser.occupancy;
    if (seen.empty()) return seen;
    return {seen.i_begin - 1, seen.j_begin - 1, seen.i_end + 1, seen.j_end + 1}; // frontiers surround free cells
}

grid::CellBox bounds_of(const LayerBounds& bounds) noexcept {
    grid::CellBox all = bounds.laser.occupancy;
    all.include(bounds.laser.himm);
    all.include(bounds.sonar);
    return all;
}

} // namespace scanloom::mapping
