#pragma once

#include "lab/document.hpp"
#include "lab/landmark_experiment.hpp"

#include <string_view>

/// The report of the landmark experiment. Its files and folder have the names of report.hpp.
namespace scanloom::lab {

/// Returns the part that is equal, byte by byte, for equal seeds and recordings.
[[nodiscard]] Document landmark_report_of(const LandmarkResults& results);

/// Returns the part that differs each time: the durations.
/// @param machine  description of the machine, see machine_description()
[[nodiscard]] Document landmark_times_report_of(const LandmarkResults& results, std::string_view machine);

} // namespace scanloom::lab
