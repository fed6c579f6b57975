#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/support/child_process.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::fault {

/// Runs scanloom-load, which reports the acknowledgement latency of its robots and whether all scans arrived.
class PacedLoad {
public:
    static constexpr unsigned kSessions = 4;

    struct Robots {
        unsigned count = 20;
        unsigned sessions = kSessions;
        unsigned rate = 10; ///< scans per second of each robot; 0: as fast as the server permits
    };

    struct Report {
        Outcome outcome;
        /// Latency of acknowledgements, from the time at which each scan was due. nullopt if scanloom-load does not
        /// report it, as for robots without a pace.
        std::optional<double> p99_ms{};
    };

    /// Starts the program. Its standard error goes to `place`/load-SEED.log.
    PacedLoad(const ServerProcess& server, const Robots& robots, std::uint64_t seed, std::chrono::seconds duration,
              const std::filesystem::path& place);

    /// Waits until its sessions exist.
    void wait_until_it_streams() const;

    [[nodiscard]] std::string session(unsigned n) const {
        return "load-" + std::to_string(seed_) + "-" + std::to_string(n);
    }

    /// Waits until the program has ended, including its verification.
    [[nodiscard]] Report finish();

    /// Parses the output of scanloom-load. @param code  its exit code
    [[nodiscard]] static Report read_report(std::string_view text, int code);

private:
    const ServerProcess& server_;
    Robots robots_;
    std::uint64_t seed_;
    test::ChildProcess program_;
};

} // namespace scanloom::fault
