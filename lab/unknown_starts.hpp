#pragma once

#include "common/scan/poses.hpp"
#include "lab/recorded_log.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// How soon a robot that starts anywhere is located in the map of another one.
namespace scanloom::lab {

/// A log that two robots share: the first one takes the scans up to one of them, and the second one, which starts with
/// an odometry frame of its own, the rest.
struct UnknownStart {
    /// Where the second robot was located.
    struct Found {
        std::size_t scans = 0; ///< that it took until then
        double path = 0.0;     ///< metres until then, by the odometry
        double metres = 0.0;   ///< between its pose then and that in the plain estimate
        double degrees = 0.0;  ///< likewise
    };

    Poses poses = Poses::kOdometry; ///< of the second robot; kOdometry or kNone
    double first_part = 0.0;        ///< of the scans, that the first robot takes
    std::optional<Found> found;     ///< nullopt: it was not located
};

/// Lets a second robot start after 30, 40 ... 80 % of a log, with and without odometry. The first robot has odometry.
/// @param plain  the estimate of the whole log with odometry: T_map_robot of each scan
[[nodiscard]] std::vector<UnknownStart> start_anywhere(const RecordedLog& log,
                                                       std::span<const robot::StampedPose> plain);

} // namespace scanloom::lab
