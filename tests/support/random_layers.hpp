#pragma once

#include "core/classify/class_layer.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/random_map.hpp"

#include <map>
#include <random>
#include <vector>

namespace scanloom::testing_support {

/// Returns patches of free cells with a few walls; all other cells are unexplored.
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

/// All layers, filled at random chunk by chunk and independently of each other.
class RandomLayers {
public:
    /// Fills these chunks with new random values.
    void fill(const std::vector<grid::ChunkKey>& keys, std::mt19937& random, Revision revision) {
        for (const auto& key : keys) fill(key, random, revision);
        classes_.update(
            keys,
            [&](grid::ChunkKey key) {
                const auto found = types_.find(key);
                return found == types_.end() ? nullptr : &found->second;
            },
            revision);
    }

    [[nodiscard]] mapping::Snapshot snapshot(Revision revision) {
        return {.revision = revision,
                .laser = lasers_.snapshot(),
                .sonar = sonars_.snapshot(),
                .classes = classes_.snapshot()};
    }

private:
    void fill(grid::ChunkKey key, std::mt19937& random, Revision revision) {
        auto& laser = lasers_.restore(key, revision);
        auto& sonar = sonars_.restore(key, revision);
        const unsigned keep_one_in = random() % 2 == 0 ? 1 : 1000; // so that whole chunks also differ
        for (std::size_t n = 0; n < 4096; ++n) {
            const bool is_kept = random() % keep_one_in == 0;
            laser.occupancy[n] = is_kept ? random_cell(random) : mapping::kUnknownLogOdds;
            laser.himm[n] = is_kept && random() % 2 == 0
                                ? static_cast<mapping::HimmCount>(random() % 16 * (random() % 2))
                                : mapping::kUnseenHimm;
            sonar.cells[n] = random() % keep_one_in == 0 ? random_cell(random) : mapping::kUnknownLogOdds;
        }
        if (random() % 3 != 0) types_[key] = random_types(random);
    }

    mapping::LaserLayers lasers_{mapping::MapConfig{}};
    mapping::SonarLayer sonars_{mapping::MapConfig{}};
    classify::ClassLayer classes_{3};
    std::map<grid::ChunkKey, classify::OccPlanes> types_;
};

/// Returns a snapshot in which all layers are filled around the origin, at the edges of the tiled area, and beyond.
inline mapping::Snapshot random_layers(unsigned seed) {
    std::mt19937 random(seed);
    const auto keys = scattered_chunks(random);
    RandomLayers layers;
    layers.fill(keys, random, 1);
    return layers.snapshot(1);
}

} // namespace scanloom::testing_support
