#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/session_options.hpp"
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

/// The maps of a log that nothing has disturbed: its entries, folded one after the other in this process.
/// Errors  kMalformed: an entry that cannot follow those before it.
[[nodiscard]] Result<std::map<std::string, std::string>> undisturbed_digests(const std::vector<LogEntry>& log,
                                                                             const SessionOptions& options);

/// The absolute check of one session: every scan that a robot was told is durable is held, as it was sent, once and in
/// order; nothing is held that nobody sent; the maps are those of an undisturbed run.
/// Pre  `robots` are all those of the session.
[[nodiscard]] Outcome verify(const Held& held, std::span<const RobotStanding> robots, const SessionOptions& options);

/// What a server answers over HTTP. Throws where it does not answer, or not with 200.
[[nodiscard]] Held ask_for(std::uint16_t http_port, const std::string& session);

/// verify() of every session of the robots, with what the server answers; and no robot has given up. A session to which
/// nothing was acknowledged may be missing.
[[nodiscard]] Outcome verify_server(std::uint16_t http_port, std::span<const RobotStanding> robots);

} // namespace scanloom::fault
