#pragma once

#include "server/landmarks/alignment.hpp"
#include "server/landmarks/alignment_evidence.hpp"
#include "server/landmarks/refinement.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::landmarks {

/// What was seen from one place or from several, in one frame, for others to be laid on.
struct Seen {
    Surface surface;
    std::vector<const Horizon*> horizons; ///< of the places it was seen from; they must outlive it
    bool is_map = false;                  ///< seen from several: what was seen more often is drawn thicker
};

/// The direction in which lines hold a pose least, and how much, of the elements used.
struct WeakDirection {
    Point2 direction;
    double held;
};
[[nodiscard]] WeakDirection weak_direction(const LineFit& fit);

/// Whether two poses are further apart than kDistinctDistance or kDistinctTurn.
[[nodiscard]] bool is_distinct(const Pose2& a, const Pose2& b);

/// A refined pose, and what speaks for it.
struct Candidate {
    LineFit fit;
    Evidence second_in_first;
    Evidence first_in_second;
    bool is_on_map = false;
    /// Of two views, the second's elements in the first, then the first's in the second; none where it lies on a map.
    std::vector<Finding> findings;
    std::vector<Point2> places; ///< of these elements in the first's frame

    [[nodiscard]] const Pose2& pose() const { return fit.T_first_second; }
    [[nodiscard]] Evidence both() const { return second_in_first + first_in_second; }
    /// On a map only the view's elements count as matched: a wall that is drawn thicker has more than it has length.
    [[nodiscard]] double score() const;
};

/// Surface elements by which two poses differ: each that one of them explains and the other does not counts as one, and
/// as more where one is contradicted, as in Candidate::score().
struct Difference {
    double for_one = 0.0;
    double for_other = 0.0;
    double of_one_thing = 0.0; ///< of what is for one, the most that lies around a place: one thing that moved, perhaps
};

/// @param thing_radius  metres
/// Pre   both are of the same two views.
/// Cost  the square of the elements that are for one.
[[nodiscard]] Difference difference(const Candidate& one, const Candidate& other, double thing_radius);

/// The candidate that a start leads to, which is off by a few centimetres: see settle().
/// Pre  both have surface elements; the second's frame has its origin where it was seen from.
[[nodiscard]] Candidate judged(const Seen& first, const Seen& second, const Pose2& start);

/// The best, and the few others that are distinct and nearly as good: each may be the truth once it is slid.
[[nodiscard]] std::vector<Candidate> likely(std::vector<Candidate> candidates);

/// Adds what `best` becomes when it is slid along the direction that is held least, as a pose that slides along a
/// corridor comes to rest at whatever is near.
void add_slid(const Seen& first, const Seen& second, const Candidate& best, std::vector<Candidate>& candidates);

/// By score, the best first; of those that say the same as the best, the one that fits best before all others.
void rank(std::vector<Candidate>& candidates);

} // namespace scanloom::landmarks
