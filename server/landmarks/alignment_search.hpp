#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/alignment_surfels.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::size_t kSurfelsMax = 250;

/// Of many surface elements as many, evenly among the cloud's rows.
[[nodiscard]] std::vector<Surfel> sample(std::span<const Surfel> surfels, std::size_t count_max);

/// The poses in which two surfaces might lie on each other, the likeliest first; all distinct, none refined: a good one
/// is within about 0.2 m and 3 degrees of what it stands for.
///
/// For each of evenly spread rotations every pair of surface elements of like direction votes for the translation that
/// lays one on the other; where votes heap up is a hypothesis. So no guess is needed, and rivals are found as well.
/// @param distance_max  metres that the second frame's origin may be from the first's, along each axis
/// @param count_max     so many hypotheses at most
/// @param first_max     so many surface elements of the first stand for all at most; of the second kSurfelsMax
/// @param ask           before each rotation; its error ends it
/// Cost    rotations by pairs of those that stand for all.
/// Source  Ballard, Generalizing the Hough transform to detect arbitrary shapes (1981); Olson, Real-time correlative scan
///         matching (2009), for looking everywhere.
[[nodiscard]] Result<std::vector<Pose2>> find_hypotheses(
    std::span<const Surfel> first, std::span<const Surfel> second, double distance_max, std::size_t count_max,
    std::size_t first_max = kSurfelsMax, const std::function<Result<>()>& ask = [] { return Result<>(); });

/// Likewise of one rotation alone: where things repeat, most of the places they may be taken for.
[[nodiscard]] std::vector<Pose2> find_translations(std::span<const Surfel> first, std::span<const Surfel> second,
                                                   double yaw, double distance_max, std::size_t count_max,
                                                   std::size_t first_max = kSurfelsMax);

} // namespace scanloom::landmarks
