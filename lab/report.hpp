#pragma once

#include "lab/experiment.hpp"
#include "lab/landmark_experiment.hpp"
#include "lab/localization_experiment.hpp"

#include <string>
#include <string_view>
#include <vector>

/// The reports of the experiments, as Markdown.
namespace scanloom::lab {

/// Names of a report's files, without extension.
inline constexpr const char* kReportFile = "report";
inline constexpr const char* kTimesFile = "times";

/// Returns the part that is equal, byte by byte, for equal matrices.
[[nodiscard]] std::string report_of(const Matrix& matrix, const std::vector<RunResult>& results);

/// Returns the part that differs each time: the durations.
/// @param machine  description of the machine, see machine_description()
[[nodiscard]] std::string times_report_of(const Matrix& matrix, const std::vector<RunResult>& results,
                                          std::string_view machine);

/// Returns the part that is equal, byte by byte, for equal seeds and recordings. A figure without a value (a share of
/// nothing) is a dash.
[[nodiscard]] std::string report_of(const LandmarkResults& results);

/// Returns the part that differs each time: the durations.
/// @param machine  description of the machine, see machine_description()
[[nodiscard]] std::string times_report_of(const LandmarkResults& results, std::string_view machine);

/// What the report of localization shows.
struct LocalizationResults {
    std::vector<LogFiles> files;
    std::vector<LogResult> logs; ///< of these files
};

/// Returns the part that is equal, byte by byte, for equal logs and relations. Logs that are named "intel" and "fr079"
/// are compared with published figures.
[[nodiscard]] std::string report_of(const LocalizationResults& results);

/// Returns the part that differs each time: the durations.
/// @param machine  description of the machine, see machine_description()
[[nodiscard]] std::string times_report_of(const LocalizationResults& results, std::string_view machine);

} // namespace scanloom::lab
