#pragma once

#include "lab/landmark_experiment.hpp"
#include "lab/published_landmarks.hpp"

#include <span>
#include <string>
#include <vector>

/// Sentences about the figures of the landmark experiment. They are derived from the figures only.
namespace scanloom::lab {

/// Compares values with a published range as both are printed, with two decimals: "within", "above" or "below" if all
/// values are, else "partly outside".
/// Pre: there are values.
[[nodiscard]] std::string placed(std::span<const double> values, const ValueRange& published);

/// Describes persistence, stability and continuity with the door moved, compared with the published values, and
/// explains values outside their range.
[[nodiscard]] std::vector<std::string> door_findings(const LandmarkResults& results);

/// Describes the distances of matched landmarks at the published tolerance, compared with the published ones.
[[nodiscard]] std::string tolerance_finding(const LandmarkResults& results);

/// States from which window on filtered corners are rounded: further from the truth than unfiltered ones.
[[nodiscard]] std::string window_finding(const std::vector<FilterRow>& rows);

/// Describes the largest errors of alignments, and the alignments that are not clear.
[[nodiscard]] std::vector<std::string> alignment_findings(const LandmarkResults& results);

/// Describes the poses computed from matched landmarks alone, why surfaces are used instead, and each refusal.
[[nodiscard]] std::vector<std::string> method_findings(const LandmarkResults& results);

/// Compares the halves of a recording with the published values.
[[nodiscard]] std::string recording_finding(const RecordedResult& recorded);

} // namespace scanloom::lab
