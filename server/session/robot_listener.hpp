#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace scanloom::session {

/// What a session tells the link of a robot. Called on the session's strand: hand over, do not block.
class RobotListener {
public:
    virtual ~RobotListener() = default;

    /// Every scan up to durable_seq is in the log and in the map; `bytes` more of what was submitted
    /// need no credit any longer.
    virtual void on_durable(std::uint64_t durable_seq, std::size_t bytes) = 0;

    /// The session will take nothing more from this link.
    virtual void on_failed(const Error& error) = 0;
};

/// Who joins, as its hello says.
struct Newcomer {
    std::string robot;
    std::string source = {};                ///< Hello.source
    std::optional<double> body_radius = {}; ///< metres
};

/// What a robot learns when it joins.
struct Joined {
    RobotIndex robot = 0;
    std::uint64_t last_durable_seq = 0;
    std::set<std::uint32_t> sensors = {}; ///< that it has described, on whatever link
};

} // namespace scanloom::session
