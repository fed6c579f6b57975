#pragma once

#include "server/landmarks/alignment_surfels.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// The poses in which two surfaces might lie on each other, the likeliest first; all distinct, none refined: a good one
/// is within about 0.2 m and 3 degrees of what it stands for.
///
/// For each of evenly spread rotations every pair of surface elements of like direction votes for the translation that
/// lays one on the other; where votes heap up is a hypothesis. So no guess is needed, and rivals are found as well.
/// @param distance_max  metres that the second frame's origin may be from the first's, along each axis
/// @param count_max     so many hypotheses at most
/// Cost    rotations by pairs, of some hundred surface elements that stand for all.
/// Source  Ballard, Generalizing the Hough transform to detect arbitrary shapes (1981); Olson, Real-time correlative scan
///         matching (2009), for looking everywhere.
[[nodiscard]] std::vector<Pose2> find_hypotheses(std::span<const Surfel> first, std::span<const Surfel> second,
                                                 double distance_max, std::size_t count_max);

} // namespace scanloom::landmarks
