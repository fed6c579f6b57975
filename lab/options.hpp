#pragma once

#include "common/app/program.hpp"
#include "common/scan/poses.hpp"
#include "lab/cluster_plan.hpp"
#include "lab/perturbed_source.hpp"
#include "lab/recorded_log.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace scanloom::lab {

struct ExperimentOptions {
    std::string out;                  ///< directory of the report
    std::uint64_t seed = 1;           ///< of the noise
    std::optional<std::size_t> scans; ///< per run
    bool quick = false;
};

struct LandmarkOptions {
    std::string out;                    ///< directory of the report
    std::uint64_t seed = 1;             ///< of the noise
    std::optional<std::string> capture; ///< file with the bytes that an LD06 sent
};

struct ScoreOptions {
    std::string log;                       ///< CARMEN log
    std::string relations;                 ///< file with verified relative poses
    Poses poses = Poses::kOdometry;        ///< kOdometry or kNone
    std::optional<std::string> trajectory; ///< file for the final poses
    Perturbation perturbation;
};

struct LocalizationOptions {
    std::string out;             ///< directory of the report
    std::vector<LogFiles> files; ///< at least one log, with different names
};

/// What a program is asked to do.
using Options = std::variant<ExperimentOptions, LandmarkOptions, ScoreOptions, LocalizationOptions, cluster::Plan>;

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag overrides the environment,
/// which overrides the file.
[[nodiscard]] std::variant<Options, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::lab
