#pragma once

#include "core/mapping/projection.hpp"

namespace scanloom::testing_support {

/// Returns a projection restored from the data that a checkpoint of `original` would hold.
inline mapping::Projection restored(mapping::Projection& original) {
    mapping::Projection copy{original.config()};
    copy.restore(original.state());
    const auto saved = original.snapshot();
    saved.laser.visit({}, 0, [&](grid::ChunkKey key, const mapping::LaserChunk& chunk) {
        auto& again = copy.restore_laser_chunk(key, chunk.revision);
        again.occupancy = chunk.occupancy;
        again.himm = chunk.himm;
        again.occ_types = chunk.occ_types;
    });
    saved.sonar.visit({}, 0, [&](grid::ChunkKey key, const mapping::SonarChunk& chunk) {
        copy.restore_sonar_chunk(key, chunk.revision).cells = chunk.cells;
    });
    return copy;
}

} // namespace scanloom::testing_support
