#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// What a run of faults came to. The check is the same after every fault, and absolute: no acknowledged scan lost, none
/// applied twice, the digest equal to an undisturbed run's.
struct Outcome {
    std::uint64_t acknowledged = 0; ///< scans of which a robot was told that they are durable
    std::uint64_t lost = 0;         ///< of those, scans that the server does not hold
    std::uint64_t twice = 0;        ///< scans that the server holds once more than they were sent
    bool digest_equal = true;
    std::vector<std::string> amiss{};               ///< whatever is wrong, a sentence each
    std::map<std::string, std::uint64_t> figures{}; ///< what else a row counts, by name
    std::optional<std::string> repeat{};            ///< the command that does the first of it again
    std::optional<std::string> skipped{};           ///< why nothing was run

    [[nodiscard]] bool passed() const { return lost == 0 && twice == 0 && digest_equal && amiss.empty(); }

    /// Adds that of another part of the run.
    void add(Outcome part);
};

/// One line: {"row": ..., "seed": ..., "count": ..., "lost": ..., "twice": ..., "digest_equal": ..., "seconds": ...,
/// ...}
[[nodiscard]] std::string json_line(std::string_view row, std::uint64_t seed, std::uint64_t count, double seconds,
                                    const Outcome& outcome);

} // namespace scanloom::fault
