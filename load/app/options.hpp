#pragma once

#include "common/app/link_options.hpp"
#include "common/app/program.hpp"
#include "load/core/fault_schedule.hpp"
#include "load/core/report.hpp"

#include <cstdint>
#include <string>
#include <variant>

namespace scanloom::load {

struct HttpAddress : net::Address {
    bool tls = false;
};

struct LoadOptions : LinkOptions, RunSettings {
    HttpAddress http{{"127.0.0.1", "8080"}};

    double connections_per_second = 500.0;
    double give_up_after = 30.0; ///< seconds
    std::uint32_t course = 600;  ///< scans until they repeat
    FaultMeans faults{};

    Verify verify = Verify::kDigests;
    bool keep = false;
    bool replace = false;
    std::string json_file; ///< empty: none
};

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag overrides the environment,
/// which overrides the file.
[[nodiscard]] std::variant<LoadOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::load
