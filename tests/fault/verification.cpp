#include "tests/fault/verification.hpp"

#include "common/wire/log_codec.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/projection.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/running_server.hpp"

#include <boost/endian/conversion.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace scanloom::fault {
namespace {

/// The log's data of the robots, by their index in it.
struct LoggedRobots {
    std::vector<std::string> names;
    std::map<std::string, std::map<std::uint64_t, std::uint64_t>> times_held; ///< of each seq, by robot
};

const RobotStanding* find(std::span<const RobotStanding> robots, const std::string& name) {
    const auto found = std::ranges::find(robots, name, [](const RobotStanding& robot) { return robot.plan.name; });
    return found == robots.end() ? nullptr : &*found;
}

/// Returns the error of a scan checked by itself, or nullopt.
std::optional<std::string> error_of(const ScanTaken& taken, const LoggedRobots& robots_in_log,
                                    std::span<const RobotStanding> robots) {
    if (taken.robot >= robots_in_log.names.size())
        return fmt::format("a scan belongs to robot {}, which never joined", taken.robot);
    const std::string& name = robots_in_log.names[taken.robot];
    const RobotStanding* robot = find(robots, name);
    if (robot == nullptr) return fmt::format("a scan belongs to robot '{}', which does not exist", name);
    if (taken.scan.seq == 0 || taken.scan.seq > robot->plan.scans) {
        return fmt::format("robot '{}' has scan {}, which was never sent", name, taken.scan.seq);
    }
    if (taken.scan != testing_support::random_scan(robot->plan.seed, taken.scan.seq)) {
        return fmt::format("scan {} of robot '{}' differs from the sent one", taken.scan.seq, name);
    }
    return std::nullopt;
}

/// Adds the name of the robot that joins with this entry.
void note_joining(const LogEntry& entry, LoggedRobots& robots_in_log) {
    const auto* joined = std::get_if<RobotJoined>(&entry);
    if (joined == nullptr) return;
    robots_in_log.names.resize(std::max<std::size_t>(robots_in_log.names.size(), joined->robot + 1));
    robots_in_log.names[joined->robot] = joined->name;
}

void read_log(const std::vector<LogEntry>& log, std::span<const RobotStanding> robots, LoggedRobots& robots_in_log,
              Outcome& outcome) {
    for (const LogEntry& entry : log) {
        note_joining(entry, robots_in_log);
        const auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken == nullptr) continue;
        if (auto wrong = error_of(*taken, robots_in_log, robots)) {
            outcome.failures.push_back(std::move(*wrong));
        } else {
            ++robots_in_log.times_held[robots_in_log.names[taken->robot]][taken->scan.seq];
        }
    }
}

Outcome count_scans(const std::string& robot, std::uint64_t acknowledged,
                    const std::map<std::uint64_t, std::uint64_t>& times_held) {
    Outcome outcome;
    outcome.acknowledged = acknowledged;
    for (std::uint64_t seq = 1; seq <= acknowledged; ++seq) {
        if (!times_held.contains(seq)) ++outcome.lost;
    }
    for (const auto& [seq, times] : times_held) outcome.twice += times - 1;
    if (outcome.lost > 0) {
        outcome.failures.push_back(
            fmt::format("{} of the {} acknowledged scans of robot '{}' are lost", outcome.lost, acknowledged, robot));
    }
    if (outcome.twice > 0) {
        outcome.failures.push_back(fmt::format("{} scans of robot '{}' are duplicates", outcome.twice, robot));
    }
    return outcome;
}

void compare_maps(const Held& held, const SessionOptions& options, Outcome& outcome) {
    if (held.revision != held.log.size()) {
        outcome.failures.push_back(
            fmt::format("the maps have revision {}, but the log has {} entries", held.revision, held.log.size()));
    }
    const auto right = undisturbed_digests(held.log, options);
    outcome.digest_equal = right && *right == held.digests;
    if (!right) outcome.failures.push_back("the maps of the log cannot be computed: " + right.error().message);
    if (right && !outcome.digest_equal)
        outcome.failures.emplace_back("the maps differ from those of an undisturbed run");
}

std::map<std::string, std::string> digests_of(const mapping::Snapshot& maps) {
    std::map<std::string, std::string> digests;
    for (const auto layer : mapping::kLayers) {
        digests.emplace(mapping::name_of(layer), mapping::digest_of(maps, layer));
    }
    return digests;
}

test::HttpAnswer must_get(std::uint16_t port, const std::string& target) {
    auto answer = test::http_request(port, "GET", target);
    if (answer.status == 200) return answer;
    throw std::runtime_error(fmt::format("{} is answered with {}: {}", target, answer.status, answer.body));
}

/// Parses a log in the form that HTTP serves: each entry with its length prefix.
std::vector<LogEntry> parse_log(std::string_view bytes) {
    constexpr std::size_t kLengthBytes = 4;
    std::vector<LogEntry> log;
    while (!bytes.empty()) {
        if (bytes.size() < kLengthBytes) throw std::runtime_error("the log ends within a length");
        const auto length = boost::endian::load_big_u32(reinterpret_cast<const unsigned char*>(bytes.data()));
        bytes.remove_prefix(kLengthBytes);
        if (bytes.size() < length) throw std::runtime_error("the log ends within an entry");
        log.push_back(wire::decode_entry(bytes.substr(0, length)).value());
        bytes.remove_prefix(length);
    }
    return log;
}

} // namespace

Held held(const mapping::Snapshot& maps, const std::vector<std::string>& entries) {
    Held held{.revision = maps.revision, .digests = digests_of(maps)};
    for (const auto& bytes : entries) held.log.push_back(wire::decode_entry(bytes).value());
    return held;
}

Result<std::map<std::string, std::string>> undisturbed_digests(const std::vector<LogEntry>& log,
                                                               const SessionOptions& options) {
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    mapping::Projection projection(*config);
    for (const LogEntry& entry : log) {
        if (auto applied = projection.apply(entry); !applied) return applied.error();
    }
    return digests_of(projection.snapshot());
}

Outcome verify_log(const std::vector<LogEntry>& log, std::span<const RobotStanding> robots) {
    Outcome outcome;
    LoggedRobots robots_in_log;
    read_log(log, robots, robots_in_log, outcome);
    for (const RobotStanding& robot : robots) {
        outcome.add(count_scans(robot.plan.name, robot.acknowledged, robots_in_log.times_held[robot.plan.name]));
    }
    return outcome;
}

Outcome verify_numbers(const std::vector<LogEntry>& log, const std::string& robot, std::uint64_t acknowledged) {
    LoggedRobots robots_in_log;
    for (const LogEntry& entry : log) {
        note_joining(entry, robots_in_log);
        const auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken != nullptr) ++robots_in_log.times_held[robots_in_log.names.at(taken->robot)][taken->scan.seq];
    }
    return count_scans(robot, acknowledged, robots_in_log.times_held[robot]);
}

Outcome verify(const Held& held, std::span<const RobotStanding> robots, const SessionOptions& options) {
    Outcome outcome = verify_log(held.log, robots);
    compare_maps(held, options, outcome);
    return outcome;
}

Held ask_for(std::uint16_t http_port, const std::string& session) {
    const std::string where = "/api/v1/sessions/" + session;
    Held held;
    const auto digest = boost::json::parse(must_get(http_port, where + "/digest").body);
    held.revision = digest.at("revision").to_number<Revision>();
    for (const auto& [layer, hash] : digest.at("layers").as_object()) held.digests.emplace(layer, hash.as_string());
    held.log = parse_log(must_get(http_port, where + "/log").body);
    return held;
}

Outcome verify_server(std::uint16_t http_port, std::span<const RobotStanding> robots) {
    std::map<std::string, std::vector<RobotStanding>> sessions;
    Outcome outcome;
    for (const RobotStanding& robot : robots) {
        sessions[robot.plan.session].push_back(robot);
        if (robot.outcome) continue;
        outcome.failures.push_back(
            fmt::format("robot '{}' gave up: {}", robot.plan.name, robot.outcome.error().message));
    }
    for (const auto& [session, members] : sessions) {
        const bool has_any = std::ranges::any_of(members, [](const auto& robot) { return robot.acknowledged > 0; });
        if (!has_any && test::http_request(http_port, "GET", "/api/v1/sessions/" + session).status == 404) continue;
        outcome.add(verify(ask_for(http_port, session), members, fleet_options()));
    }
    return outcome;
}

} // namespace scanloom::fault
