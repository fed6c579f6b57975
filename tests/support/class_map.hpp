#pragma once

#include "common/geometry/pose2.hpp"
#include "core/classify/class_layer.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

namespace scanloom::testing_support {

using classify::CellClass;
using classify::class_at;
using classify::ClassView;
using classify::OccType;
using grid::Cell;

/// A map whose cells are set one by one.
class ClassMap {
public:
    void set(Cell cell, CellClass value) { tree_.write(grid::chunk_of(cell), 1).at(cell) = value; }
    [[nodiscard]] ClassView view() { return tree_.snapshot(); }

private:
    static std::shared_ptr<const classify::ClassChunk> blank() {
        classify::ClassChunk chunk;
        chunk.cells.fill(CellClass::kUnexplored);
        return std::make_shared<const classify::ClassChunk>(chunk);
    }

    grid::ChunkTree<classify::ClassChunk> tree_{blank()};
};

/// Returns the map drawn in `rows`, the top row first, with its lower left cell at `corner`: '#' is occupied, '.' free,
/// '!' danger, 'f' frontier, any other character unexplored.
[[nodiscard]] inline ClassView drawn(const std::vector<std::string_view>& rows, Cell corner = {0, 0}) {
    ClassMap map;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (std::size_t column = 0; column < rows[row].size(); ++column) {
            const char c = rows[row][column];
            const auto value = c == '#'   ? CellClass::kOccupied
                               : c == '.' ? CellClass::kFree
                               : c == '!' ? CellClass::kDanger
                               : c == 'f' ? CellClass::kFrontier
                                          : CellClass::kUnexplored;
            map.set({corner.i + static_cast<std::int32_t>(column),
                     corner.j + static_cast<std::int32_t>(rows.size() - 1 - row)},
                    value);
        }
    }
    return map.view();
}

/// Returns the classes that follow from the OccTypes of the cells of a box.
template <class TypeAt>
[[nodiscard]] ClassView classified(const grid::CellBox& box, std::int32_t danger_cells, TypeAt&& type_at) {
    std::map<grid::ChunkKey, std::unique_ptr<classify::OccPlanes>> planes;
    for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
            auto& plane = planes[grid::chunk_of({i, j})];
            if (!plane) plane = std::make_unique<classify::OccPlanes>();
            plane->set({i, j}, type_at(Cell{i, j}));
        }
    }
    std::vector<grid::ChunkKey> keys;
    for (const auto& [key, plane] : planes) keys.push_back(key);
    classify::ClassLayer layer(danger_cells);
    layer.update(
        keys, [&](grid::ChunkKey key) { return planes.at(key).get(); }, 1);
    return layer.snapshot();
}

/// Returns a random number of 0 .. count - 1.
[[nodiscard]] inline std::int32_t random_below(std::mt19937& random, std::int32_t count) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(count));
}

/// Returns a box of cells with random classes, most of them free.
[[nodiscard]] inline ClassView scattered(std::mt19937& random, const grid::CellBox& box, int obstacles_in_100) {
    ClassMap map;
    for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
            const std::int32_t dice = random_below(random, 100);
            const auto value = dice < obstacles_in_100        ? CellClass::kOccupied
                               : dice < obstacles_in_100 + 4  ? CellClass::kUnexplored
                               : dice < obstacles_in_100 + 6  ? CellClass::kFrontier
                               : dice < obstacles_in_100 + 30 ? CellClass::kDanger
                                                              : CellClass::kFree;
            map.set({i, j}, value);
        }
    }
    return map.view();
}

[[nodiscard]] inline Point2 centre(Cell cell, double cell_size_m) {
    return {(cell.i + 0.5) * cell_size_m, (cell.j + 0.5) * cell_size_m};
}

} // namespace scanloom::testing_support
