#pragma once

#include <optional>

namespace scanloom::load {

/// Resources that a process used, since its start or between two moments.
struct ProcessUse {
    double cpu_seconds = 0.0;
    double resident_bytes = 0.0; ///< at the end
};

/// What the server's process reports about itself at one moment.
struct ServerUse {
    ProcessUse so_far;
    double started = 0.0; ///< seconds since the epoch; identifies the process, as a restarted one has another value
};

/// Resources that the server used between two moments.
struct ServerUsed {
    std::optional<double> cpu_seconds; ///< absent: it was restarted meanwhile, so the value is unknown
    double resident_bytes = 0.0;       ///< at the end
};

/// Absent if the server did not report at both moments.
[[nodiscard]] std::optional<ServerUsed> used_between(const std::optional<ServerUse>& before,
                                                     const std::optional<ServerUse>& after);

} // namespace scanloom::load
