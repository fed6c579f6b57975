#pragma once

#include "lab/landmark_experiment.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

/// Sentences about the figures of the landmark experiment. They are derived from the figures only.
namespace scanloom::lab {

/// The smallest and the largest value.
using ValueRange = std::array<double, 2>;

/// Published values for the landmarks of a real room, for orientation: both the room and the lidar were others.
inline constexpr ValueRange kPublishedPersistence{0.18, 0.49};
inline constexpr ValueRange kPublishedStability{0.67, 0.89};
inline constexpr ValueRange kPublishedContinuity{0.43, 0.46};

inline constexpr double kPublishedTolerance = 0.1;      ///< metres, for the two values below
inline constexpr double kPublishedDistanceMean = 0.018; ///< metres
inline constexpr double kPublishedDistanceSigma = 0.013;

/// Compares values with a published range as both are printed, with two decimals: "within", "above" or "below" if all
/// values are, else "partly outside".
/// Pre: there are values.
[[nodiscard]] std::string placed(std::span<const double> values, const ValueRange& published);

/// Describes persistence, stability and continuity with the door moved, compared with the published values, and
/// explains values outside their range.
[[nodiscard]] std::vector<std::string> door_findings(const LandmarkResults& results);

/// Describes the distances of matched landmarks at the published tolerance, compared with the published ones.
[[nodiscard]] std::string tolerance_finding(const LandmarkResults& results);

/// States from which window on filtered corners are rounded: further from the ground truth than unfiltered ones.
[[nodiscard]] std::string window_finding(const std::vector<FilterRow>& rows);

/// Compares the halves of a recording with the published values.
[[nodiscard]] std::string recording_finding(const RecordedResult& recorded);

} // namespace scanloom::lab
