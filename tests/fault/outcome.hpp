#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// The result of a run of faults. The check is the same after every fault, and absolute: no acknowledged scan lost, no
/// scan applied twice, the digest equal to that of an undisturbed run.
struct Outcome {
    std::uint64_t acknowledged = 0; ///< scans that were acknowledged to a robot as durable
    std::uint64_t lost = 0;         ///< acknowledged scans that the server does not hold
    std::uint64_t twice = 0;        ///< extra copies of scans that the server holds
    bool digest_equal = true;
    std::vector<std::string> failures{};            ///< one sentence for each failure
    std::map<std::string, std::uint64_t> figures{}; ///< further results of the row, by name
    std::optional<std::string> repeat{};            ///< the command that repeats the first failure
    std::optional<std::string> skipped{};           ///< the reason if the row was not run

    [[nodiscard]] bool passed() const { return lost == 0 && twice == 0 && digest_equal && failures.empty(); }

    /// Adds the result of another part of the run.
    void add(Outcome part);
};

/// Returns one line: {"row": ..., "seed": ..., "count": ..., "lost": ..., "twice": ..., "digest_equal": ..., "seconds":
/// ..., ...}
[[nodiscard]] std::string json_line(std::string_view row, std::uint64_t seed, std::uint64_t count, double seconds,
                                    const Outcome& outcome);

} // namespace scanloom::fault
