#pragma once

#include "server/landmarks/continuity.hpp"
#include "server/landmarks/landmark.hpp"
#include "server/landmarks/metrics.hpp"

#include <span>
#include <vector>

namespace scanloom::lab {

/// A capture and the landmarks found in it.
struct SeenLandmarks {
    std::vector<Point2> points; ///< metres, in any frame
    landmarks::LandmarkSurvey survey;
    std::vector<landmarks::Continuity> continuity; ///< one for each landmark
};

/// Finds the landmarks of a capture with the default settings.
/// Errors: those of survey_landmarks().
[[nodiscard]] Result<SeenLandmarks> see_landmarks(std::vector<Point2> points);

/// How similar the landmarks of two captures are.
struct Comparison {
    std::vector<landmarks::Match> matches;
    landmarks::Metrics metrics;
    std::size_t only_first = 0; ///< landmarks of the first capture without a match in the second
    std::size_t only_second = 0;
    landmarks::Continuity continuity; ///< mean of each part over the landmarks of both captures; 0 if there are none
};

/// Compares the landmarks of two captures.
/// @param tolerance  metres, as for match()
/// Frames: both captures are in the same frame.
/// Errors: those of match().
[[nodiscard]] Result<Comparison> compare(const SeenLandmarks& first, const SeenLandmarks& second,
                                         double tolerance = landmarks::kTolerance);

} // namespace scanloom::lab
