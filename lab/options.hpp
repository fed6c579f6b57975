#pragma once

#include "common/app/program.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::lab {

struct ExperimentOptions {
    std::string out;                  ///< directory of the report
    std::uint64_t seed = 1;           ///< of the noise
    std::optional<std::size_t> scans; ///< of each run
    bool quick = false;
};

struct TruthOptions {
    std::string world = "room";
    double cell_size = 0.05; ///< metres
    std::string out;         ///< directory of map.pgm and map.yaml
};

using LabOptions = std::variant<ExperimentOptions, TruthOptions>;

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag beats the environment,
/// which beats the file.
[[nodiscard]] std::variant<LabOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::lab
