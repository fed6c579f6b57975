#pragma once

#include "core/landmarks/filter_figures.hpp"
#include "core/landmarks/landmark.hpp"
#include "core/landmarks/landmark_matching.hpp"
#include "lab/integrate_recording.hpp"
#include "lab/recording.hpp"

#include <array>
#include <span>
#include <utility>
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

/// What the landmark experiment varies while everything else is constant.
namespace scanloom::lab {

/// Tolerances in metres, 0.1 to 1.0.
inline constexpr std::array kTolerances{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};

struct ToleranceRow {
    double tolerance = 0.0;
    landmarks::Metrics metrics;
};

/// Returns a row for each of kTolerances.
/// @param pairs  each first capture with its second; the figures of a row cover the matches of all pairs
/// Errors: those of compare().
[[nodiscard]] Result<std::vector<ToleranceRow>>
sweep_tolerances(std::span<const std::pair<const SeenLandmarks*, const SeenLandmarks*>> pairs);

/// Readings of a capture: turns of the lidar, one scan each.
inline constexpr std::array<std::size_t, 7> kReadings{50, 100, 200, 300, 500, 700, 1000};

struct ReadingsRow {
    std::size_t readings = 0;
    std::size_t points = 0;
    std::size_t landmarks = 0;
    double eps = 0.0;             ///< metres, used to find the landmarks
    std::size_t robot_bytes = 0;  ///< see robot_bytes()
    std::size_t server_bytes = 0; ///< see clustering_bytes()
    double milliseconds = 0.0;    ///< to find the landmarks, median of kTimings; the only part that differs each time
};

inline constexpr int kTimings = 5;

/// Returns a row for each of kReadings up to the capture's number of scans. A row covers that many of the first scans.
/// Errors: those of see_landmarks().
[[nodiscard]] Result<std::vector<ReadingsRow>> sweep_readings(const LidarCapture& capture, const Now& now);

/// Widths of the filter window, in beams.
inline constexpr std::array<std::size_t, 10> kWindows{1, 3, 5, 7, 9, 11, 15, 31, 51, 101};

struct FilterRow {
    std::size_t window = 1;
    landmarks::FilterFigures figures; ///< means over the scans; for the RMSE, the root of the mean square
    double wall_error = 0.0;          ///< metres, see sweep_windows()
    double corner_error = 0.0;
};

/// Returns a row for each of kWindows: the effect of the median filter on every scan of a capture.
///
/// The errors are median distances between filtered readings and those of a lidar without noise: one for beams at a
/// corner or an edge, one for the others. A beam is at a corner if, less than four beams from it, three neighbouring
/// points without noise bend by more than 5 cm, |a - 2 b + c|.
/// Shapes: without_noise has the same beams; all scans are full circles, and every beam has a return.
[[nodiscard]] std::vector<FilterRow> sweep_windows(const LidarCapture& capture, const Scan& without_noise);

} // namespace scanloom::lab
