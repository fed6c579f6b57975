#pragma once

#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace scanloom {

/// The state of a cell in an imported map. The log stores these values.
enum class MapCell : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

inline constexpr std::size_t kMapPatchCellsMax = std::size_t{512} << 10; ///< cells of one patch

/// A part of an imported map: whole rows of cells.
struct MapPatch {
    double cell_size = 0.05;    ///< metres, of the imported map
    double min_x = 0.0;         ///< metres: the lower-left corner of the first cell, in the map frame
    double min_y = 0.0;         ///< metres: the same corner
    std::uint32_t width = 0;    ///< cells
    std::vector<MapCell> cells; ///< row by row from the bottom, `width` cells per row

    /// Returns the number of rows.
    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }

    friend bool operator==(const MapPatch&, const MapPatch&) = default;
};

/// A robot's number within its session: 0, 1, 2, ... in order of joining.
using RobotIndex = std::uint32_t;

/// The number of entries in a session's log up to and including one of them: the first entry has revision 1. Also
/// identifies the state of a map after that entry is applied.
using Revision = std::uint64_t;

/// A robot joins the session. It may join again with another body radius or, while it has no scans, another source and
/// other poses.
struct RobotJoined {
    RobotIndex robot = 0;    ///< the next free number if the robot is new to the session
    std::string name;        ///< unique within the session; see is_valid_name()
    std::string source = {}; ///< identifies a recording or simulation, so that no other continues it; empty: none
    std::optional<double> body_radius = {}; ///< metres, above 0, at most kBodyRadiusMax; nullopt: not stated
    Poses poses = Poses::kMap;              ///< whether its scans have poses; the same for all scans of a robot

    friend bool operator==(const RobotJoined&, const RobotJoined&) = default;
};

/// A robot describes one of its sensors, or describes it again. It applies to the robot's later scans.
struct SensorDescribed {
    RobotIndex robot = 0; ///< a robot that has joined
    Sensor sensor;        ///< replaces an earlier description with the same id

    friend bool operator==(const SensorDescribed&, const SensorDescribed&) = default;
};

/// A robot took a scan.
struct ScanTaken {
    RobotIndex robot = 0;          ///< a robot that has joined
    Scan scan;                     ///< its seq follows that of the robot's previous scan
    bool is_localize_only = false; ///< whether the mode was on when it arrived; see ModeChanged

    friend bool operator==(const ScanTaken&, const ScanTaken&) = default;
};

/// When and where a robot took a scan, which decides whether the scan is integrated.
struct ScanPose {
    RobotIndex robot = 0;          ///< the robot that took it
    std::uint64_t seq = 0;         ///< Scan::seq
    double stamp = 0.0;            ///< seconds
    std::optional<Pose2> pose;     ///< T_map_robot; nullopt: not known, see Scan::pose
    bool is_localize_only = false; ///< ScanTaken::is_localize_only

    friend bool operator==(const ScanPose&, const ScanPose&) = default;
};

/// Returns when and where a scan was taken.
[[nodiscard]] inline ScanPose scan_pose_of(const ScanTaken& taken) noexcept {
    return {taken.robot, taken.scan.seq, taken.scan.stamp, taken.scan.pose, taken.is_localize_only};
}

/// A range of stamps in seconds, both ends included.
struct StampRange {
    double from = 0.0; ///< seconds
    double to = 0.0;   ///< seconds, not less than `from`

    friend bool operator==(const StampRange&, const StampRange&) = default;
};

/// A range of sequence numbers, both ends included.
struct SeqRange {
    std::uint64_t from = 0; ///< Scan::seq of the first scan
    std::uint64_t to = 0;   ///< Scan::seq of the last scan

    friend bool operator==(const SeqRange&, const SeqRange&) = default;
};

/// An operator excludes scans of a robot from the maps: those in the range whose log entries precede this one.
struct ScansExcluded {
    std::uint64_t id = 0;                     ///< starts at 1 and rises within the session
    RobotIndex robot = 0;                     ///< whose scans are excluded
    std::variant<StampRange, SeqRange> scans; ///< which of its scans

    friend bool operator==(const ScansExcluded&, const ScansExcluded&) = default;
};

/// An operator lifts the exclusion with this id: it has no effect any more.
struct ExclusionLifted {
    std::uint64_t id = 0; ///< ScansExcluded::id

    friend bool operator==(const ExclusionLifted&, const ExclusionLifted&) = default;
};

/// The server shows maps in which the scans stand at corrected poses. When poses are corrected depends on the scans
/// alone, so this entry changes no map; it has a revision of its own, at which readers find the maps changed.
struct MapsCorrected {
    Revision as_of = 0; ///< the poses are those that were estimated after this entry

    friend bool operator==(const MapsCorrected&, const MapsCorrected&) = default;
};

/// An operator says where a robot is whose poses the server estimates: its next scan is searched for there.
struct RobotRelocalized {
    RobotIndex robot = 0;  ///< a robot whose poses are not Poses::kMap
    Point2 near{0.0, 0.0}; ///< metres, map frame
    double radius = 0.0;   ///< metres, positive: the robot is at most this far from `near`

    friend bool operator==(const RobotRelocalized&, const RobotRelocalized&) = default;
};

/// An operator turns localize-only mode on or off: while it is on, scans show where the robots are, and the map does
/// not change.
struct ModeChanged {
    bool is_localize_only = false; ///< from the next entry on

    friend bool operator==(const ModeChanged&, const ModeChanged&) = default;
};

/// One entry of a session's append-only log, from which all maps are computed.
using LogEntry = std::variant<RobotJoined, SensorDescribed, ScanTaken, MapPatch, ScansExcluded, ExclusionLifted,
                              MapsCorrected, RobotRelocalized, ModeChanged>;

} // namespace scanloom
