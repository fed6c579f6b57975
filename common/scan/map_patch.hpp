#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom {

/// What an imported map says of a cell. As in the log.
enum class MapCell : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

inline constexpr std::size_t kMapPatchCellsMax = std::size_t{512} << 10; ///< cells of one patch

/// A part of a map that was made elsewhere: whole rows of it.
struct MapPatch {
    double cell_size = 0.05; ///< metres, of the map
    double min_x = 0.0;      ///< metres: the lower-left corner of the first cell, in the map frame
    double min_y = 0.0;
    std::uint32_t width = 0;    ///< cells
    std::vector<MapCell> cells; ///< row by row from the bottom, width of them each

    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }

    friend bool operator==(const MapPatch&, const MapPatch&) = default;
};

} // namespace scanloom
