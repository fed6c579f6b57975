#pragma once

#include "common/error/error.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/map_image.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace scanloom::tiles {

/// What two maps, A and B, say of a place.
enum class Difference : std::uint8_t {
    kNeither,      ///< neither knows it
    kOnlyA,        ///< only A knows it, whatever it says
    kOnlyB,        ///< only B does
    kBothFree,     ///< they agree
    kBothOccupied, ///< they agree
    kFreeOccupied, ///< A says free, B says occupied
    kOccupiedFree, ///< A says occupied, B says free
    kUndecided,    ///< both know it, and at least one says neither free nor occupied
};

/// As they stand in answers, by Difference.
inline constexpr std::array<std::string_view, 8> kDifferenceNames = {
    "neither", "only_a", "only_b", "both_free", "both_occupied", "free_occupied", "occupied_free", "undecided"};

/// Two maps of one layer, laid upon each other on the grid of the finer one: a place is the centre of a finer cell, and
/// a cell of the coarser map stands for all centres inside it (those on its lower and left borders included).
///
/// Free, occupied or undecided is what each map says by the class thresholds of its own settings, from the cell's
/// value alone:
///   occupancy, sonar  probability >= class_p_occupied is occupied, <= class_p_free is free
///   himm              counter >= class_himm_occupied is occupied, <= class_himm_free is free
///   classification    the class underneath: danger is free, and a frontier is as unknown as unexplored ground
struct ComparedMaps {
    const mapping::Snapshot& a;
    const mapping::Snapshot& b;
    mapping::Layer layer = mapping::Layer::kOccupancy;
};

/// What a comparison comes to.
struct DifferenceSums {
    std::array<std::uint64_t, kDifferenceNames.size()> cells{}; ///< by Difference
    std::uint64_t known = 0;                                    ///< by both
    std::uint64_t agreeing = 0;                                 ///< of them: both free, both occupied or both undecided
    double difference = 0.0; ///< of probability, absolute, summed over `known`; 0 for layers that have none
};

/// The places to compare: all that either map shows anything in, or those of a bbox.
/// @param bytes_per_pixel  as of map_frame()
/// Errors  those of map_frame(); kNotFound only when neither map has seen anything.
[[nodiscard]] Result<MapFrame> difference_frame(const ComparedMaps& maps, const std::optional<Extent>& bbox,
                                                std::int64_t bytes_per_pixel = 1);

/// Called with each row from the top.
using UseDifferences = std::function<void(std::span<const Difference>)>;

/// Cost: the places. Memory: some rows of them.
DifferenceSums compare(const ComparedMaps& maps, const MapFrame& frame, const UseDifferences& use = {});

/// Indexed by Difference, in colours that colour-blind eyes tell apart: clear where neither knows, greys where they
/// agree, blue where A alone knows or sees an obstacle, orange for B.
[[nodiscard]] Bytes difference_png(const ComparedMaps& maps, const MapFrame& frame);

} // namespace scanloom::tiles
