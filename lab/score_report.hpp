#pragma once

#include "lab/options.hpp"
#include "lab/trajectory_score.hpp"

#include <cstddef>
#include <string>

namespace scanloom::lab {

/// The result of the command score.
struct ScoreResult {
    std::size_t scans = 0;         ///< that were estimated
    std::size_t skipped_lines = 0; ///< of the log
    double cpu_seconds = 0.0;      ///< of the estimation
    TrajectoryScore final_poses;   ///< after the last scan
    TrajectoryScore first_poses;   ///< each as estimated when its scan was added
};

/// Returns a table for people; the last line has no line ending.
[[nodiscard]] std::string score_table(const ScoreOptions& options, const ScoreResult& result);

/// Returns one line of JSON, without line ending.
[[nodiscard]] std::string score_json(const ScoreOptions& options, const ScoreResult& result);

} // namespace scanloom::lab
