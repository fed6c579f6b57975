#pragma once

#include "server/landmarks/continuity.hpp"
#include "server/landmarks/landmark.hpp"
#include "server/landmarks/metrics.hpp"

#include <span>
#include <vector>

namespace scanloom::lab {

/// A capture, and the landmarks that were found in it.
struct SeenLandmarks {
    std::vector<Point2> points; ///< metres, of any frame
    landmarks::LandmarkSurvey survey;
    std::vector<landmarks::Continuity> continuity; ///< of each landmark
};

/// By the settings that landmarks have by default.
/// Errors  those of survey_landmarks().
[[nodiscard]] Result<SeenLandmarks> see_landmarks(std::vector<Point2> points);

/// How alike two captures are, in their landmarks.
struct Comparison {
    std::vector<landmarks::Match> matches;
    landmarks::Metrics metrics;
    std::size_t only_first = 0; ///< landmarks of the first capture that match none of the second
    std::size_t only_second = 0;
    landmarks::Continuity continuity; ///< each part of it the mean over the landmarks of both; 0 where there are none
};

/// @param tolerance  metres, as match() takes it
/// Frames  both in one.
/// Errors  those of match().
[[nodiscard]] Result<Comparison> compare(const SeenLandmarks& first, const SeenLandmarks& second,
                                         double tolerance = landmarks::kTolerance);

} // namespace scanloom::lab
