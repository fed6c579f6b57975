#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "lab/recorded_log.hpp"
#include "server/tiles/bytes.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace scanloom::lab {

/// The picture of an occupancy map, a pixel for each cell: white free, black occupied, mid-grey unknown.
struct MapPicture {
    tiles::Bytes png;
    double cell_size = 0.0; ///< metres
    std::int32_t width = 0; ///< pixels
    std::int32_t height = 0;
};

/// Draws the map that a session with default settings makes of scans at given poses. Cells are as small as the side
/// allows: 0.05, 0.1, 0.2, 0.5 or 1 m.
/// @param scans     of lasers
/// @param poses     T_map_robot of each scan; nullopt: the scan is not in the map
/// @param side_max  pixels
/// Errors: kTooLarge if the map is larger than side_max cells of 1 m; kNotFound if nothing is observed; kInvalidField
///         or kMalformed if a session would not accept the scans.
[[nodiscard]] Result<MapPicture> draw_map(std::span<const robot::Observation> scans,
                                          std::span<const std::optional<Pose2>> poses, std::int32_t side_max);

} // namespace scanloom::lab
