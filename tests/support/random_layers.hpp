#pragma once

#include "server/classify/class_layer.hpp"
#include "server/mapping/snapshot.hpp"
#include "tests/support/random_map.hpp"

#include <map>
#include <random>
#include <vector>

namespace scanloom::testing_support {

/// Patches of free ground with a wall here and there; the rest unexplored.
inline classify::OccPlanes random_types(std::mt19937& random) {
    classify::OccPlanes types;
    const auto side = static_cast<std::int32_t>(1 + random() % 64);
    const auto wall = static_cast<std::int32_t>(random() % 64);
    for (std::int32_t j = 0; j < side; ++j) {
        for (std::int32_t i = 0; i < side; ++i) {
            const bool is_wall = i == wall || random() % 500 == 0;
            types.set({i, j}, is_wall ? classify::OccType::kOccupied : classify::OccType::kFree);
        }
    }
    return types;
}

/// A snapshot with all layers filled at random, each apart from the others: around the origin, at the edges of what
/// tiles show, and beyond.
inline mapping::Snapshot random_layers(unsigned seed) {
    std::mt19937 random(seed);
    mapping::LaserLayers lasers{mapping::MapConfig{}};
    mapping::SonarLayer sonars{mapping::MapConfig{}};
    classify::ClassLayer classes(3);
    std::map<grid::ChunkKey, classify::OccPlanes> types;
    std::vector<grid::ChunkKey> keys = scattered_chunks(random);
    for (const auto& key : keys) {
        auto& laser = lasers.restore(key, 1);
        auto& sonar = sonars.restore(key, 1);
        const unsigned keep_one_in = random() % 2 == 0 ? 1 : 1000; // so that whole chunks differ, too
        for (std::size_t n = 0; n < 4096; ++n) {
            const bool is_kept = random() % keep_one_in == 0;
            laser.occupancy[n] = is_kept ? random_cell(random) : mapping::kUnknownLogOdds;
            laser.himm[n] = is_kept && random() % 2 == 0
                                ? static_cast<mapping::HimmCount>(random() % 16 * (random() % 2))
                                : mapping::kUnseenHimm;
            sonar.cells[n] = random() % keep_one_in == 0 ? random_cell(random) : mapping::kUnknownLogOdds;
        }
        if (random() % 3 != 0) types[key] = random_types(random);
    }
    classes.update(
        keys,
        [&](grid::ChunkKey key) {
            const auto found = types.find(key);
            return found == types.end() ? nullptr : &found->second;
        },
        1);
    return {.revision = 1, .laser = lasers.snapshot(), .sonar = sonars.snapshot(), .classes = classes.snapshot()};
}

} // namespace scanloom::testing_support
