#pragma once

#include "common/error/error.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/map_image.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace scanloom::tiles {

/// The comparison of two maps, A and B, at one place.
enum class Difference : std::uint8_t {
    kNeither,      ///< unknown in both
    kOnlyA,        ///< known in A only
    kOnlyB,        ///< known in B only
    kBothFree,     ///< free in both
    kBothOccupied, ///< occupied in both
    kFreeOccupied, ///< free in A, occupied in B
    kOccupiedFree, ///< occupied in A, free in B
    kUndecided,    ///< known in both, but in at least one neither free nor occupied
};

/// The names in API responses, by Difference.
inline constexpr std::array<std::string_view, 8> kDifferenceNames = {
    "neither", "only_a", "only_b", "both_free", "both_occupied", "free_occupied", "occupied_free", "undecided"};

/// Two maps of one layer, compared on the grid of the map with the smaller cells. A place is the centre of a cell of
/// that grid. A cell of the coarser map represents all centres inside it, including those on its lower and left
/// borders.
///
/// Each map's cell is free, occupied or undecided according to its value and the class thresholds of that map's
/// settings:
///   occupancy, sonar  probability >= class_p_occupied is occupied, <= class_p_free is free
///   himm              counter >= class_himm_occupied is occupied, <= class_himm_free is free
///   classification    danger is free; a frontier is unknown, like an unexplored cell
struct ComparedMaps {
    const mapping::Snapshot& a;
    const mapping::Snapshot& b;
    mapping::Layer layer = mapping::Layer::kOccupancy;
};

/// The totals of a comparison.
struct DifferenceSums {
    std::array<std::uint64_t, kDifferenceNames.size()> cells{}; ///< by Difference
    std::uint64_t known = 0;                                    ///< known in both maps
    std::uint64_t agreeing = 0; ///< of `known`: both free, both occupied or both undecided
    double difference = 0.0;    ///< sum of |p_A - p_B| over `known`; 0 for layers without probabilities
};

/// Returns the places to compare: all places where either map shows anything, or those of a bbox.
/// @param bbox  map frame, metres
/// @param bytes_per_pixel  see map_frame()
/// Errors: kNotFound if there is no bbox and both maps are empty; kTooLarge if the frame exceeds the pixel limits of
///         map_frame(); kInvalidField if the bbox is invalid.
[[nodiscard]] Result<MapFrame> difference_frame(const ComparedMaps& maps, const std::optional<Extent>& bbox,
                                                std::int64_t bytes_per_pixel = 1);

/// Receives each row of a comparison, from the top.
using UseDifferences = std::function<void(std::span<const Difference>)>;

/// Compares two maps.
/// @param frame  from difference_frame()
/// @param use  if set, receives the differences row by row
/// Cost: proportional to the number of places.
/// Memory: a few rows of places.
DifferenceSums compare(const ComparedMaps& maps, const MapFrame& frame, const UseDifferences& use = {});

/// Returns a comparison as a PNG with palette indices equal to Difference. The colours can be distinguished with colour
/// blindness: transparent where neither map knows the place, greys where they agree, blue where only A knows it or sees
/// an obstacle, orange for B.
[[nodiscard]] Bytes difference_png(const ComparedMaps& maps, const MapFrame& frame);

} // namespace scanloom::tiles
