#pragma once

#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::robot {

enum class Truth : std::uint8_t {
    kOutside,  ///< beyond the walls, or shut in between solids: no way leads there from a floor; or not known,
               ///< though rays pass through what is not known
    kFree,     ///< nothing stands in the cell
    kOccupied, ///< a solid stands in the cell or in a part of it
};

/// What a perfect map of a world would hold. Walkers are no part of it: they come and go.
struct TruthGrid {
    double cell_size = 0.0;   ///< metres
    std::int32_t i_begin = 0; ///< cell (0, 0) has its lower-left corner at the world origin, as in maps
    std::int32_t j_begin = 0;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<Truth> cells; ///< width * height, bottom row first

    /// Everything beyond the grid is outside.
    [[nodiscard]] Truth at(std::int32_t i, std::int32_t j) const noexcept {
        const bool inside = i >= i_begin && j >= j_begin && i < i_begin + width && j < j_begin + height;
        if (!inside) return Truth::kOutside;
        return cells[static_cast<std::size_t>(j - j_begin) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(i - i_begin)];
    }
};

/// The grid that covers all solids and floors of the world. A solid whose side lies on the border of a cell does not
/// stand in it.
/// Pre     0.005 <= cell_size_m <= 1; openings that robots use are 0.2 m wide at least.
/// Cost    the cells, at cells of 0.1 m or less.
[[nodiscard]] TruthGrid truth_of(const World& world, double cell_size_m);

} // namespace scanloom::robot
