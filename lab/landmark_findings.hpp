#pragma once

#include "lab/landmark_experiment.hpp"
#include "lab/published_landmarks.hpp"

#include <span>
#include <string>
#include <vector>

/// What the figures of the landmark experiment say, in sentences. All of it is told by the figures.
namespace scanloom::lab {

/// Where values lie by what is published: "within", "above" or "below" it (all of them), or "partly outside" it, as
/// they are written, with two digits behind the point. Pre  there are some.
[[nodiscard]] std::string placed(std::span<const double> values, const ValueRange& published);

/// Persistence, stability and continuity with the door moved, beside what is published, and why where they lie outside.
[[nodiscard]] std::vector<std::string> door_findings(const LandmarkResults& results);

/// The distances of matched landmarks at the published tolerance, beside what is published.
[[nodiscard]] std::string tolerance_finding(const LandmarkResults& results);

/// From which window on corners go round: those further from the truth than unfiltered ones.
[[nodiscard]] std::string window_finding(const std::vector<FilterRow>& rows);

/// How far alignments are from the truth at most, and what those say that are not clear.
[[nodiscard]] std::vector<std::string> alignment_findings(const LandmarkResults& results);

/// What matched landmarks alone tell of poses, why surfaces are used instead, and each refusal.
[[nodiscard]] std::vector<std::string> ways_findings(const LandmarkResults& results);

/// The halves of a recording beside what is published.
[[nodiscard]] std::string recording_finding(const RecordedResult& recorded);

} // namespace scanloom::lab
