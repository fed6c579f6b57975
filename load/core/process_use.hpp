#pragma once

#include <optional>

namespace scanloom::load {

/// What a process has used, since it was started or between two moments.
struct ProcessUse {
    double cpu_seconds = 0.0;
    double resident_bytes = 0.0; ///< at the end
};

/// What the server's process says of itself at one moment.
struct ServerUse {
    ProcessUse so_far;
    double started = 0.0; ///< seconds since the epoch; tells it from one that was started later
};

/// What the server used between two moments.
struct ServerUsed {
    std::optional<double> cpu_seconds; ///< absent: it was started anew meanwhile, and nobody knows
    double resident_bytes = 0.0;       ///< at the end
};

/// Absent where the server did not say both times.
[[nodiscard]] std::optional<ServerUsed> used_between(const std::optional<ServerUse>& before,
                                                     const std::optional<ServerUse>& after);

} // namespace scanloom::load
