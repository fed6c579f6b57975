#pragma once

#include "common/app/program.hpp"
#include "load/core/fault_schedule.hpp"
#include "load/core/verdict.hpp"
#include "robot_client/uplink/server_address.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::load {

struct LoadOptions {
    robot::ServerAddress server;
    robot::ServerAddress http;
    bool http_tls = false;  ///< --http began with https://
    std::string token_file; ///< empty: no token
    bool tls = false;
    std::string tls_ca_file;   ///< empty: certificates that the system trusts
    std::string tls_cert_file; ///< client certificate for both ports; empty: none
    std::string tls_key_file;

    std::uint32_t robots = 100;
    std::uint32_t sessions = 0; ///< as given; parse_options() replaces 0 by one per robot
    double rate = 10.0;         ///< scans per second of each robot; 0: as fast as the credit allows
    std::uint32_t batch = 1;    ///< scans per frame
    double duration = 30.0;     ///< seconds
    double connections_per_second = 500.0;
    double give_up_after = 30.0; ///< seconds
    std::uint32_t threads = 1;

    std::string world = "office";
    std::string laser = "reference";
    std::string noise = "none";
    std::uint64_t seed = 1;
    std::uint32_t course = 600;      ///< scans until they repeat
    std::optional<double> cell_size; ///< metres

    std::uint32_t viewers = 0;
    std::uint32_t tile_readers = 0;
    double tile_rate = 20.0; ///< tiles per second of each reader
    std::string faults_text;
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
