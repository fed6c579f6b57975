#pragma once

#include "lab/document.hpp"
#include "lab/experiment.hpp"

#include <string_view>

namespace scanloom::lab {

/// Names of the report's files, without extension, and of its folder for pictures.
inline constexpr const char* kReportFile = "report";
inline constexpr const char* kTimesFile = "times";
inline constexpr const char* kPicturesFolder = "pictures";

/// Returns the part that is equal, byte by byte, for equal matrices.
[[nodiscard]] Document report_of(const Matrix& matrix, const std::vector<RunResult>& results);

/// Returns the part that differs each time: the durations.
/// @param machine  description of the machine, see machine_description()
[[nodiscard]] Document times_report_of(const Matrix& matrix, const std::vector<RunResult>& results,
                                       std::string_view machine);

} // namespace scanloom::lab
