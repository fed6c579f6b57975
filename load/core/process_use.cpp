#include "load/core/process_use.hpp"

namespace scanloom::load {

std::optional<ServerUsed> used_between(const std::optional<ServerUse>& before, const std::optional<ServerUse>& after) {
    if (!before || !after) return std::nullopt;
    ServerUsed used{std::nullopt, after->so_far.resident_bytes};
    const double cpu_seconds = after->so_far.cpu_seconds - before->so_far.cpu_seconds;
    const bool is_same_process = before->started == after->started && cpu_seconds >= 0.0;
    if (is_same_process) used.cpu_seconds = cpu_seconds;
    return used;
}

} // namespace scanloom::load
