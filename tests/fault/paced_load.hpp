#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/support/child_process.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace scanloom::fault {

/// Robots of scanloom-load that keep their pace, and say how soon they were acknowledged and whether all is there.
class PacedLoad {
public:
    static constexpr unsigned kRobots = 20;
    static constexpr unsigned kSessions = 4;

    struct Report {
        Outcome outcome;
        double p99_ms = 0.0; ///< of acknowledgements, from when each scan was meant to be sent
    };

    /// Begins. What it says on standard error is in `place`/load.log.
    PacedLoad(const ServerProcess& server, std::uint64_t seed, std::chrono::seconds duration,
              const std::filesystem::path& place);

    /// Waits until its sessions are there.
    void wait_until_it_streams() const;

    [[nodiscard]] std::string session(unsigned n) const {
        return "load-" + std::to_string(seed_) + "-" + std::to_string(n);
    }

    /// Waits for its end, and for what it then verifies.
    [[nodiscard]] Report finish();

private:
    const ServerProcess& server_;
    std::uint64_t seed_;
    test::ChildProcess program_;
};

} // namespace scanloom::fault
