#pragma once

#include "common/scan/map_patch.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace scanloom {

/// A robot's number within its session, 0, 1, 2, ... in order of joining.
using RobotIndex = std::uint32_t;

/// Number of entries in a session's log up to and including one of them: the first entry has
/// revision 1. Also the state of a map after folding that entry.
using Revision = std::uint64_t;

/// A robot's first appearance; or again, with another body, or as long as it has no scans with another source.
struct RobotJoined {
    RobotIndex robot = 0;
    std::string name;
    std::string source = {}; ///< identifies a recording or simulation, so that no other continues it; empty: none
    std::optional<double> body_radius = {}; ///< metres, above 0, at most kBodyRadiusMax; nothing: not stated

    friend bool operator==(const RobotJoined&, const RobotJoined&) = default;
};

struct SensorDescribed {
    RobotIndex robot = 0;
    Sensor sensor;

    friend bool operator==(const SensorDescribed&, const SensorDescribed&) = default;
};

struct ScanTaken {
    RobotIndex robot = 0;
    Scan scan;

    friend bool operator==(const ScanTaken&, const ScanTaken&) = default;
};

/// One entry of a session's append-only log, from which every map is woven.
using LogEntry = std::variant<RobotJoined, SensorDescribed, ScanTaken, MapPatch>;

} // namespace scanloom
