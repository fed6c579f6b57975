#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/session_options.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/outcome.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace scanloom::fault {

/// A session's data on a server.
struct Held {
    std::vector<LogEntry> log;                  ///< from the first entry on
    Revision revision = 0;                      ///< of the maps
    std::map<std::string, std::string> digests; ///< of the maps, by layer
};

/// Returns the data of a server in this process: its maps, and the stored entries of its log.
[[nodiscard]] Held held(const mapping::Snapshot& maps, const std::vector<std::string>& entries);

/// Returns the digests of the maps that result from applying the entries of a log one after the other in this process.
/// Errors  kMalformed: an entry that cannot follow those before it.
[[nodiscard]] Result<std::map<std::string, std::string>> undisturbed_digests(const std::vector<LogEntry>& log,
                                                                             const SessionOptions& options);

/// Verifies that every scan acknowledged to a robot as durable is in the log once, unchanged, and that the log contains
/// only scans that were sent.
/// Pre  `robots` are all robots of the session.
[[nodiscard]] Outcome verify_log(const std::vector<LogEntry>& log, std::span<const RobotStanding> robots);

/// Verifies that every scan up to this number is in the robot's log once, whatever its contents.
[[nodiscard]] Outcome verify_numbers(const std::vector<LogEntry>& log, const std::string& robot,
                                     std::uint64_t acknowledged);

/// The absolute check of one session: verify_log(), entries in order, and maps equal to those of an undisturbed run.
[[nodiscard]] Outcome verify(const Held& held, std::span<const RobotStanding> robots, const SessionOptions& options);

/// Returns a server's data of a session, read over HTTP. Throws if the server does not answer with status 200.
[[nodiscard]] Held ask_for(std::uint16_t http_port, const std::string& session);

/// Runs verify() for every session of the robots with the server's answers, and checks that no robot has given up. A
/// session without acknowledged scans may be missing.
[[nodiscard]] Outcome verify_server(std::uint16_t http_port, std::span<const RobotStanding> robots);

} // namespace scanloom::fault
