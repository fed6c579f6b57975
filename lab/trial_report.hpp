#pragma once

#include "lab/alignment_trials.hpp"
#include "lab/document.hpp"

#include <string>
#include <vector>

/// The part of the landmark report about many scenes: results as tables and sentences.
namespace scanloom::lab {

/// Adds the results of the trials to a report.
void add_trials(Document& document, const TrialResults& results);

/// Adds the durations of the trials to a report.
void add_trial_times(Document& document, const TrialResults& results);

/// Sentences about how many results are right, and about each wrong one with its seed and its error.
[[nodiscard]] std::vector<std::string> alignment_trial_findings(const TrialResults& results);
[[nodiscard]] std::vector<std::string> locating_trial_findings(const TrialResults& results);
[[nodiscard]] std::vector<std::string> stranger_findings(const TrialResults& results);

} // namespace scanloom::lab
