#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// What the server has acknowledged to one robot.
struct ExpectedRobot {
    std::string name;
    std::uint64_t scans = 0;
};

struct ExpectedSession {
    std::string name;
    std::vector<ExpectedRobot> robots;
};

/// What the server says of a session when it is asked afterwards.
struct FoundRobot {
    std::string name;
    std::uint64_t scans = 0;
    std::uint64_t last_seq = 0;
};

struct FoundSession {
    std::uint64_t scans = 0;
    std::uint64_t revision = 0; ///< entries in its log
    std::vector<FoundRobot> robots;
};

/// What contradicts the acknowledgements, in a sentence; nothing where each scan is there exactly once. Every robot
/// makes two entries beside its scans: it joined, and its laser was described.
[[nodiscard]] std::optional<std::string> contradiction(const ExpectedSession& expected, const FoundSession& found);

enum class Verify { kNone, kCounts, kDigests };

/// What a run came to.
struct Evidence {
    Verify asked = Verify::kDigests;
    std::uint64_t scans_sent = 0;
    std::uint64_t scans_acknowledged = 0;
    std::uint64_t scans_lost = 0; ///< as robots found out by reconnecting
    std::uint64_t sessions = 0;
    std::uint64_t scans_in_sessions = 0;
    std::uint64_t digests_equal = 0;         ///< sessions whose maps are those of a calm run
    bool shares_sessions = false;            ///< several robots in one: their scans mix in another order each time
    std::vector<std::string> contradictions; ///< of sessions that were asked, and of digests
    std::vector<std::string> failures;       ///< robots that gave up, or what could not be asked
};

/// The plain last word.
struct Verdict {
    bool is_good = false;
    std::string sentence;
};
[[nodiscard]] Verdict verdict_on(const Evidence& evidence);

} // namespace scanloom::load
