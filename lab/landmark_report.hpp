#pragma once

#include "lab/document.hpp"
#include "lab/landmark_experiment.hpp"

#include <string_view>

/// The report of the landmark experiment: its files and folder are named as those of report.hpp.
namespace scanloom::lab {

/// Everything that is the same for the same seed and recording: the same bytes.
[[nodiscard]] Document landmark_report_of(const LandmarkResults& results);

/// What differs each time: how long it took.
/// @param machine  on which, see machine_description()
[[nodiscard]] Document landmark_times_report_of(const LandmarkResults& results, std::string_view machine);

} // namespace scanloom::lab
