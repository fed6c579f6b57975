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

/// Robots of scanloom-load, which say how soon they were acknowledged and whether all is there.
class PacedLoad {
public:
    static constexpr unsigned kSessions = 4;

    struct Robots {
        unsigned count = 20;
        unsigned sessions = kSessions;
        unsigned rate = 10; ///< scans a second of each; 0: as fast as the server lets them
    };

    struct Report {
        Outcome outcome;
        /// Of acknowledgements, from when each scan was meant to be sent; nothing where scanloom-load does not tell it,
        /// as of robots without a pace.
        std::optional<double> p99_ms{};
    };

    /// Begins. What it says on standard error is in `place`/load-SEED.log.
    PacedLoad(const ServerProcess& server, const Robots& robots, std::uint64_t seed, std::chrono::seconds duration,
              const std::filesystem::path& place);

    /// Waits until its sessions are there.
    void wait_until_it_streams() const;

    [[nodiscard]] std::string session(unsigned n) const {
        return "load-" + std::to_string(seed_) + "-" + std::to_string(n);
    }

    /// Waits for its end, and for what it then verifies.
    [[nodiscard]] Report finish();

    /// Of what scanloom-load printed, and how it ended.
    [[nodiscard]] static Report read_report(std::string_view text, int code);

private:
    const ServerProcess& server_;
    Robots robots_;
    std::uint64_t seed_;
    test::ChildProcess program_;
};

} // namespace scanloom::fault
