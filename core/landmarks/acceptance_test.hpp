#pragma once

#include "core/landmarks/alignment.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"

#include <vector>

namespace scanloom::landmarks {

/// What a view was matched against.
enum class MatchedAgainst {
    kView, ///< a view from one other place
    kMap,  ///< a map seen from many places: mostly not visible from one place, and maybe incomplete
};

/// Performs the acceptance test: returns the best candidate and whether it can be relied on; see Alignment.
///
/// On a map, more of the view must be found, little of it may lie in the map's free space, and its position may be less
/// accurate, because the map is no more accurate itself. If the view is not found as a whole, a distant pose with fewer
/// inliers and hardly more outliers makes the result ambiguous: the map may be incomplete there, and the best pose may
/// only look similar.
///
/// For two views, a pose near the best with hardly fewer inliers does not make the result ambiguous if by far most of
/// the elements in which the two differ support the best, and not only the elements of one thing, which may have
/// moved. All surface elements of both views are compared for this. A distant pose makes the result ambiguous even with
/// fewer inliers if fewer of its elements lie in observed free space.
/// @param candidates  of one view, ranked
/// @param against     what the candidates were matched against
/// Precondition: the candidates are ranked; see rank().
[[nodiscard]] Alignment test_acceptance(const std::vector<Candidate>& candidates, MatchedAgainst against);

} // namespace scanloom::landmarks
