#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "server/landmarks/cloud_view.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::landmarks {

inline constexpr std::size_t kViewPointsMin = 20; ///< points of a view that is aligned

struct AlignmentSettings {
    double distance_max = 5.0; ///< metres between the places that the two were seen from, along each axis of the first
};

inline constexpr double kDistinctDistance = 0.1;   ///< metres; poses that differ by less say the same
inline constexpr double kDistinctTurn = 0.0523599; ///< radians, 3 degrees

/// Whether an alignment can be relied on.
enum class Certainty {
    kClear,        ///< no other pose may be the truth as well
    kAmbiguous,    ///< another one does; the pose given is one of several
    kUndetermined, ///< too little of one view is seen in the other to say, or to say well
};

/// How one view lies on another.
struct Alignment {
    Pose2 T_first_second; ///< takes the second's frame into the first's
    Certainty certainty = Certainty::kUndetermined;
    std::string why;            ///< a sentence; empty when it is clear
    std::optional<Pose2> rival; ///< the best of the other poses that may be the truth as well

    /// Parts, 0 to 1, of the second's surface, every 10 cm of which count as one.
    double explained = 0.0;      ///< lies on what the first shows
    double contradicted = 0.0;   ///< stands where the first looked through: things that moved, or a wrong pose
    double rms = 0.0;            ///< metres, of the explained from the lines of the first
    double position_sigma = 0.0; ///< metres, where the second was seen from, in the direction least known
    double yaw_sigma = 0.0;      ///< radians
};

/// Whether a view can be aligned.
/// Errors  kInvalidField, naming the view: a point, or where it was seen from (see check_points()); fewer than
///         kViewPointsMin points.
[[nodiscard]] Result<> check_view(std::string_view name, const CloudView& view);

/// How two views of one place lie on each other, without any guess: all poses are looked at, the best ones refined, and
/// judged by what both views saw and by what they saw through.
///
/// Certainty  ambiguous: another pose, more than kDistinctDistance or kDistinctTurn away, explains the views nearly as
///            well (a room that is symmetric but for little) and no second thing tells them apart, or it explains less
///            and is contradicted less; or nothing holds the pose in some direction (a corridor, along its axis).
///            Undetermined: little of the views overlaps, or much contradicts, or the place is known to within 2 cm
///            only (3 position_sigma). A pose is given all the same, for whoever looks on. Whether it is one place at
///            all no alignment can tell: rooms may be equal.
/// Units      the sigmas are those of the fit, by the residuals and the surface's directions; things that moved and
///            rivals are not in them.
/// Errors     those of check_view(); kInvalidField: a distance_max that is not more than 0 and at most 100.
/// Cost       n log n of the points, and some tens of milliseconds.
[[nodiscard]] Result<Alignment> align(const CloudView& first, const CloudView& second,
                                      const AlignmentSettings& settings = {});

} // namespace scanloom::landmarks
