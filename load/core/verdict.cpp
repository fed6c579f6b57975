#include "load/core/verdict.hpp"

#include "load/core/figure_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::load {
namespace {

constexpr std::uint64_t kEntriesBesideScans = 2; ///< for each robot

std::optional<std::string> contradiction(const std::string& session, const ExpectedRobot& expected,
                                         const FoundSession& found) {
    const auto robot = std::ranges::find(found.robots, expected.name, &FoundRobot::name);
    if (robot == found.robots.end()) return fmt::format("session {} has no robot {}", session, expected.name);
    if (robot->scans == expected.scans && robot->last_seq == expected.scans) return std::nullopt;
    return fmt::format("session {} has {} scans of robot {}, the newest with seq {}; {} were acknowledged", session,
                       grouped(robot->scans), expected.name, grouped(robot->last_seq), grouped(expected.scans));
}

std::string list_of(const std::vector<std::string>& sentences) {
    constexpr std::size_t kShown = 3;
    const auto shown = std::min(kShown, sentences.size());
    auto text =
        fmt::format("{}", fmt::join(sentences.begin(), sentences.begin() + static_cast<std::ptrdiff_t>(shown), "; "));
    if (sentences.size() > shown) text += fmt::format("; and {} more", sentences.size() - shown);
    return text;
}

std::string acknowledged(const Evidence& evidence) {
    return fmt::format("{} of {} scans acknowledged", grouped(evidence.scans_acknowledged),
                       grouped(evidence.scans_sent));
}

std::string what_was_verified(const Evidence& evidence) {
    if (evidence.verify == Verify::kNone) return "; not verified (--verify none)";
    auto text = fmt::format(", {} in {}", grouped(evidence.scans_in_sessions),
                            evidence.sessions == 1 ? "the session"
                                                   : fmt::format("the {} sessions", grouped(evidence.sessions)));
    if (evidence.verify == Verify::kCounts) return text + "; digests were not compared (--verify counts)";
    if (evidence.shares_sessions) {
        return text +
               "; digests cannot be compared, because robots share a session and the order of their scans varies";
    }
    return text + fmt::format(", {} that of an undisturbed run",
                              evidence.sessions == 1
                                  ? "its digest equals"
                                  : fmt::format("the digests of all {} equal", grouped(evidence.digests_equal)));
}

} // namespace

std::optional<std::string> contradiction(const ExpectedSession& expected, const FoundSession& found) {
    std::uint64_t scans = 0;
    for (const auto& robot : expected.robots) {
        if (auto wrong = contradiction(expected.name, robot, found)) return wrong;
        scans += robot.scans;
    }
    if (found.robots.size() != expected.robots.size()) {
        return fmt::format("session {} has {} robots; {} streamed into it", expected.name, found.robots.size(),
                           expected.robots.size());
    }
    if (found.scans != scans) {
        return fmt::format("session {} has {} scans; {} were acknowledged", expected.name, grouped(found.scans),
                           grouped(scans));
    }
    const std::uint64_t entries = scans + kEntriesBesideScans * expected.robots.size();
    if (found.revision >= entries && found.revision <= entries + found.corrections) return std::nullopt;
    return fmt::format("session {} is at revision {}; its scans and robots need {} entries", expected.name,
                       grouped(found.revision), grouped(entries));
}

Verdict verdict_on(const Evidence& evidence) {
    if (evidence.scans_lost > 0) {
        return {false, fmt::format("LOST: {} acknowledged scans are missing: {}", grouped(evidence.scans_lost),
                                   list_of(evidence.failures))};
    }
    if (!evidence.contradictions.empty()) {
        return {false, fmt::format("WRONG: {}, but {}", acknowledged(evidence), list_of(evidence.contradictions))};
    }
    if (!evidence.failures.empty()) {
        return {false, fmt::format("NOT DONE: {}: {}", acknowledged(evidence), list_of(evidence.failures))};
    }
    if (evidence.scans_acknowledged < evidence.scans_sent) {
        return {false,
                fmt::format("NOT DONE: {}; the server did not accept the others in time", acknowledged(evidence))};
    }
    return {true, fmt::format("nothing lost: {}{}", acknowledged(evidence), what_was_verified(evidence))};
}

} // namespace scanloom::load
