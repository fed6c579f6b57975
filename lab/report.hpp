#pragma once

#include "lab/document.hpp"
#include "lab/experiment.hpp"

#include <string_view>

namespace scanloom::lab {

/// Names of the report's files, without their endings, and of its folder of pictures.
inline constexpr const char* kReportFile = "report";
inline constexpr const char* kTimesFile = "times";
inline constexpr const char* kPicturesFolder = "pictures";

/// Everything that is the same whenever the same matrix is run: the same bytes.
[[nodiscard]] Document report_of(const Matrix& matrix, const std::vector<RunResult>& results);

/// What differs each time: how long it took.
/// @param machine  on which, see machine_description()
[[nodiscard]] Document times_report_of(const Matrix& matrix, const std::vector<RunResult>& results,
                                       std::string_view machine);

} // namespace scanloom::lab
