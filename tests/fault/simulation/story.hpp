#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/simulation/world.hpp"

#include <cstdint>

namespace scanloom::simulation {

struct Story {
    std::uint64_t seed = 1;
    bool hasty_disk = false;     ///< the disk lies, which the run must detect
    bool forgetful_disk = false; ///< likewise
    World::Listener listener{};  ///< receives the events
};

struct Ending {
    fault::Outcome outcome;
    std::uint64_t fingerprint = 0; ///< of all events
    std::uint64_t broken = 0;      ///< scans acknowledged as durable to a robot that the disk dropped
};

/// Runs a story: robots stream to a server while both are killed and restarted, and the network and the disk fail in
/// every simulated behaviour. Then all faults stop, and all scans must be on the server. Acknowledged scans must also
/// be on the disk whenever a server has ended. The same seed gives the same story to the nanosecond.
[[nodiscard]] Ending tell(const Story& story);

} // namespace scanloom::simulation
