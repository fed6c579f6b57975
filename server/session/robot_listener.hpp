#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace scanloom::session {

/// Receives acknowledgements and errors for a robot's link. Called on the session's strand: must not block.
class RobotListener {
public:
    virtual ~RobotListener() = default;

    /// Acknowledges scans.
    /// @param durable_seq  every scan up to this number is in the log and in the maps
    /// @param bytes  credit returned for submitted data, in addition to earlier calls
    virtual void on_durable(std::uint64_t durable_seq, std::size_t bytes) = 0;

    /// Reports the error with which the session has closed this link. It accepts no further data from it.
    virtual void on_failed(const Error& error) = 0;
};

/// A robot that joins a session, from the fields of its Hello.
struct Newcomer {
    std::string robot;
    std::string source = {};                ///< Hello.source
    std::optional<double> body_radius = {}; ///< metres
};

/// The result of joining a session.
struct Joined {
    RobotIndex robot = 0;
    std::uint64_t last_durable_seq = 0;
    std::set<std::uint32_t> sensors = {}; ///< sensors that the robot has described, on this or earlier links
};

} // namespace scanloom::session
