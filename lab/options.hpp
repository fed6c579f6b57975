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

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag beats the environment,
/// which beats the file.
[[nodiscard]] std::variant<ExperimentOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::lab
