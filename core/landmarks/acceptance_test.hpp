#pragma once

#include "core/landmarks/alignment.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"

#include <vector>

namespace scanloom::landmarks {

/// Performs the acceptance test: returns the best candidate and whether it can be relied on; see Alignment.
///
/// The certainty of the result is:
/// - kAmbiguous if another, distinct pose has nearly the best score; or if the view is not found as a whole, and a
///   distant pose has fewer inliers and hardly more outliers, because the map may be incomplete there and the best pose
///   may only look similar; or if nothing constrains the pose in some direction (a corridor, along its axis).
/// - kUndetermined if less than half of the view is in the map, if there are many outliers, or if the position is less
///   certain than 10 cm (3 position_sigma).
///
/// A pose is returned in each case, for display.
/// @param candidates  of one view
/// Precondition: the candidates are ranked; see rank().
[[nodiscard]] Alignment test_acceptance(const std::vector<Candidate>& candidates);

} // namespace scanloom::landmarks
