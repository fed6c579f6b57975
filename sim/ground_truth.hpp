#pragma once

#include "sim/drive/ground.hpp"
#include "sim/world.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::sim {

enum class GroundTruth : std::uint8_t {
    kOutside,  ///< outside the walls, enclosed by solids (not reachable from a floor), or unknown, though rays pass
               ///< through it
    kFree,     ///< nothing is in the cell
    kOccupied, ///< a solid is in the cell or in a part of it
};

/// The perfect map of a world. It does not contain walkers.
struct GroundTruthGrid {
    double cell_size = 0.0;   ///< metres
    std::int32_t i_begin = 0; ///< cell (0, 0) has its lower-left corner at the world origin, as in maps
    std::int32_t j_begin = 0;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<GroundTruth> cells; ///< width * height, bottom row first

    /// Cells outside the grid are kOutside.
    [[nodiscard]] GroundTruth at(std::int32_t i, std::int32_t j) const noexcept {
        const bool inside = i >= i_begin && j >= j_begin && i < i_begin + width && j < j_begin + height;
        if (!inside) return GroundTruth::kOutside;
        return cells[static_cast<std::size_t>(j - j_begin) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(i - i_begin)];
    }
};

/// Computes the grid that covers all solids and floors of the world. A solid whose side lies on the border of a cell
/// does not occupy that cell. Time: the number of cells, at cells of 0.1 m or less.
/// Pre: 0.005 <= cell_size_m <= 1; openings that robots use are at least 0.2 m wide.
[[nodiscard]] GroundTruthGrid ground_truth_of(const World& world, double cell_size_m);

/// Write the ground truth as the two files of ROS map_saver: occupied, free, and unknown outside.

/// Returns a binary PGM, top row first.
[[nodiscard]] std::vector<std::uint8_t> ground_truth_pgm(const GroundTruthGrid& truth);

/// Returns the YAML description. `image` is the file name of the PGM in the same folder.
[[nodiscard]] std::string ground_truth_yaml(const GroundTruthGrid& truth, std::string_view image);

/// Returns the floor plan of a known world for a robot.
[[nodiscard]] FloorPlan floor_plan_of(const GroundTruthGrid& truth);

} // namespace scanloom::sim
