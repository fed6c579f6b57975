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
    std::optional<std::size_t> scans; ///< per run
    bool quick = false;
};

struct LandmarkOptions {
    std::string out;                    ///< directory of the report
    std::uint64_t seed = 1;             ///< of the noise
    std::optional<std::string> capture; ///< file with the bytes that an LD06 sent
};

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag overrides the environment,
/// which overrides the file.
[[nodiscard]] std::variant<ExperimentOptions, LandmarkOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::lab
