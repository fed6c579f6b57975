#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// The scans of one robot that the server has acknowledged.
struct ExpectedRobot {
    std::string name;
    std::uint64_t scans = 0;
};

struct ExpectedSession {
    std::string name;
    std::vector<ExpectedRobot> robots;
};

/// The server's own count for a robot, read after the run.
struct FoundRobot {
    std::string name;
    std::uint64_t scans = 0; ///< in its log, also those without a place in the map
    std::uint64_t last_seq = 0;
};

struct FoundSession {
    std::uint64_t scans = 0;
    std::uint64_t revision = 0; ///< entries in its log
    std::vector<FoundRobot> robots;
    std::uint64_t corrections = 0; ///< of estimated poses
};

/// Returns a sentence that says what contradicts the acknowledgements; nullopt if every scan is stored exactly once.
/// Every robot adds two entries to its scans: it joined, and its laser was described. The server adds an entry when
/// maps were corrected, at most one for each correction of estimated poses.
[[nodiscard]] std::optional<std::string> contradiction(const ExpectedSession& expected, const FoundSession& found);

enum class Verify { kNone, kCounts, kDigests };

/// The results of a run that decide its verdict.
struct Evidence {
    Verify verify = Verify::kDigests;
    std::uint64_t scans_sent = 0;
    std::uint64_t scans_acknowledged = 0;
    std::uint64_t scans_lost = 0; ///< as found out when robots reconnected
    std::uint64_t sessions = 0;
    std::uint64_t scans_in_sessions = 0;
    std::uint64_t digests_equal = 0; ///< sessions whose maps equal those of an undisturbed run
    bool shares_sessions = false;    ///< several robots in a session: their scans mix in another order each time
    std::vector<std::string> contradictions; ///< of sessions that were checked, and of digests
    std::vector<std::string> failures;       ///< robots that gave up, and requests that failed
};

/// The final result in one sentence.
struct Verdict {
    bool is_good = false;
    std::string sentence;
};
[[nodiscard]] Verdict verdict_on(const Evidence& evidence);

} // namespace scanloom::load
