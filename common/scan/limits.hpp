#pragma once

#include <cstddef>
#include <numbers>
#include <string_view>

namespace scanloom {

// Limits of what a client may send. A larger value is rejected with an error that names the field.
inline constexpr std::size_t kBeamsMax = 4096;         ///< beams of one scan
inline constexpr std::size_t kSensorsMax = 64;         ///< sensors of one robot
inline constexpr std::size_t kScansPerBatchMax = 1024; ///< scans of one ScanBatch message
inline constexpr std::size_t kNameBytesMax = 64;       ///< session, robot and sensor names
inline constexpr double kCoordinateMax = 1e6;          ///< metres from the origin, each axis
inline constexpr double kBodyRadiusMax = 5.0;          ///< metres, of a robot
inline constexpr double kMapCellSizeMax = 100.0;       ///< metres, of an imported map
inline constexpr double kRangeMax = 1000.0;            ///< metres, a sensor's range_max
inline constexpr double kDurationMax = 10.0;           ///< seconds, of a scan, in either direction of the turn
inline constexpr double kReachCellsMax = 8192.0;       ///< cells of the session, a sensor's range_max

inline constexpr std::size_t kViewPointsMin = 20;     ///< of a view: fewer points do not determine a pose
inline constexpr std::size_t kViewPointsMax = 32'768; ///< of a LocateRequest, so that it fits a frame

/// The largest angle from the first to the last beam of a scan, in radians. A sensor may repeat its first direction at
/// the end of a turn, and an increment stored as float32 may carry the last beam past it: the 360 beams of a TurtleBot3
/// exceed the turn by 4.8e-6 rad.
inline constexpr double kFullTurn = 2.0 * std::numbers::pi + 1e-3;

/// Returns whether a robot may state this body radius; false for NaN.
[[nodiscard]] constexpr bool is_body_radius(double metres) noexcept { return metres > 0.0 && metres <= kBodyRadiusMax; }

/// Returns whether a session or a robot may have this name: [A-Za-z0-9_-]{1,64}. Such names are safe in URLs; they are
/// never used as paths.
[[nodiscard]] constexpr bool is_valid_name(std::string_view name) noexcept {
    if (name.empty() || name.size() > kNameBytesMax) return false;
    for (const char c : name) {
        const bool allowed =
            (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
        if (!allowed) return false;
    }
    return true;
}

} // namespace scanloom
