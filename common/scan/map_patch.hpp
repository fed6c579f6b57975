#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom {

/// The state of a cell in an imported map. The log stores these values.
enum class MapCell : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

inline constexpr std::size_t kMapPatchCellsMax = std::size_t{512} << 10; ///< cells of one patch

/// A part of an imported map: whole rows of cells.
struct MapPatch {
    double cell_size = 0.05; ///< metres, of the imported map
    double min_x = 0.0;      ///< metres: the lower-left corner of the first cell, in the map frame
    double min_y = 0.0;
    std::uint32_t width = 0;    ///< cells
    std::vector<MapCell> cells; ///< row by row from the bottom, `width` cells per row

    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }

    friend bool operator==(const MapPatch&, const MapPatch&) = default;
};

} // namespace scanloom
