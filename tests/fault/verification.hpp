#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/session_options.hpp"
#include "server/mapping/snapshot.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/outcome.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace scanloom::fault {

/// What a server holds of a session.
struct Held {
    std::vector<LogEntry> log;                  ///< from the first entry on
    Revision revision = 0;                      ///< of the maps
    std::map<std::string, std::string> digests; ///< of the maps, by layer
};

/// What a server in this process holds: its maps, and the entries of its log as they are stored.
[[nodiscard]] Held held(const mapping::Snapshot& maps, const std::vector<std::string>& entries);

/// The maps of a log that nothing has disturbed: its entries, folded one after the other in this process.
/// Errors  kMalformed: an entry that cannot follow those before it.
[[nodiscard]] Result<std::map<std::string, std::string>> undisturbed_digests(const std::vector<LogEntry>& log,
                                                                             const SessionOptions& options);

/// Every scan that a robot was told is durable is in the log, as it was sent, once; nothing is there that nobody sent.
/// Pre  `robots` are all those of the session.
[[nodiscard]] Outcome verify_log(const std::vector<LogEntry>& log, std::span<const RobotStanding> robots);

/// Every scan up to this number is in the log of the robot, once, whatever it shows.
[[nodiscard]] Outcome verify_numbers(const std::vector<LogEntry>& log, const std::string& robot,
                                     std::uint64_t acknowledged);

/// The absolute check of one session: verify_log(), in order, and the maps are those of an undisturbed run.
[[nodiscard]] Outcome verify(const Held& held, std::span<const RobotStanding> robots, const SessionOptions& options);

/// What a server answers over HTTP. Throws where it does not answer, or not with 200.
[[nodiscard]] Held ask_for(std::uint16_t http_port, const std::string& session);

/// verify() of every session of the robots, with what the server answers; and no robot has given up. A session to which
/// nothing was acknowledged may be missing.
[[nodiscard]] Outcome verify_server(std::uint16_t http_port, std::span<const RobotStanding> robots);

} // namespace scanloom::fault
