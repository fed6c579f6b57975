#include "tests/fault/simulation/promises.hpp"

#include "common/wire/log_codec.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/log_reading.hpp"

#include <algorithm>
#include <set>

namespace scanloom::simulation {
namespace {

std::vector<LogEntry> decoded(const std::vector<std::string>& entries) {
    std::vector<LogEntry> log;
    for (const auto& bytes : entries) log.push_back(wire::decode_entry(bytes).value());
    return log;
}

/// Returns the logs of all sessions on the disk, by name.
std::map<std::string, std::vector<LogEntry>> logs_of(store::MemoryScanLog& durable) {
    std::map<std::string, std::vector<LogEntry>> logs;
    for (const auto& stored : durable.sessions().value()) {
        const auto name = wire::decode_session(stored.record.value()).value().name;
        logs[name] = decoded(store::entries_after(durable, stored.id, 0).value());
    }
    return logs;
}

/// Adds the names of the robots that join in the log, by their index.
void read_names(const std::vector<LogEntry>& log, std::map<RobotIndex, std::string>& names) {
    for (const auto& entry : log) {
        if (const auto* joined = std::get_if<RobotJoined>(&entry)) names[joined->robot] = joined->name;
    }
}

} // namespace

void Promises::say(const std::string& robot, std::uint64_t seq) {
    auto& said = said_[robot];
    said = std::max(said, seq);
}

std::uint64_t Promises::promised(const std::string& robot) const {
    const auto found = said_.find(robot);
    return found == said_.end() ? 0 : found->second;
}

fault::Outcome Promises::check(store::MemoryScanLog& durable, const std::vector<fault::RobotPlan>& robots) const {
    std::map<std::string, std::vector<fault::RobotStanding>> sessions;
    for (const auto& plan : robots) {
        sessions[plan.session].push_back({.plan = plan, .acknowledged = promised(plan.name)});
    }
    auto logs = logs_of(durable);
    fault::Outcome outcome;
    for (const auto& [name, members] : sessions) outcome.add(fault::verify_log(logs[name], members));
    outcome.acknowledged = 0; // counted at the end of the story
    return outcome;
}

std::uint64_t Promises::count_broken(store::MemoryScanLog& durable, const std::vector<Disk::Dropped>& dropped) const {
    std::set<std::pair<std::string, std::uint64_t>> scans; // each once, even if it was dropped repeatedly
    for (const auto& [session, entries] : dropped) {
        std::map<RobotIndex, std::string> names;
        read_names(decoded(store::entries_after(durable, session, 0).value()), names);
        for (const auto& earlier : dropped) {
            if (earlier.session == session) read_names(decoded(earlier.entries), names);
        }
        for (const auto& entry : decoded(entries)) {
            const auto* taken = std::get_if<ScanTaken>(&entry);
            if (taken == nullptr) continue;
            const auto& name = names[taken->robot];
            if (taken->scan.seq <= promised(name)) scans.emplace(name, taken->scan.seq);
        }
    }
    return scans.size();
}

} // namespace scanloom::simulation
