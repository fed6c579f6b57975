#pragma once

#include "server/landmarks/alignment.hpp"
#include "server/landmarks/alignment_candidates.hpp"

#include <vector>

namespace scanloom::landmarks {

/// What a view was laid on.
enum class LaidOn {
    kView, ///< what was seen from one other place
    kMap,  ///< what was seen from many: most of it cannot be seen from one place, and there may be more than it has
};

/// What the candidates say: the first of them, and whether it can be relied on. See Alignment.
///
/// On a map more of the view has to be found, little of it may stand where the map is free, and its place need not be
/// known as well, as the map is no better itself. Where the view is not found as a whole, a pose elsewhere that
/// explains less of it and is not contradicted is a rival as well: the map may be incomplete there, and this one look
/// alike.
///
/// On a view a pose beside the best that explains hardly less is no rival, if by far the most of what they differ in
/// speaks for the best, and not one thing alone, which may have moved: all surface elements of both views are told
/// apart. A pose elsewhere is a rival though it explains less, if it puts less where somebody looked through.
/// Pre  they are ranked.
[[nodiscard]] Alignment judge(const std::vector<Candidate>& candidates, LaidOn first);

} // namespace scanloom::landmarks
