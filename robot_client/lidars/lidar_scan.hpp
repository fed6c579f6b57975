#pragma once

#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/lidars/lidar_turn.hpp"
#include "robot_client/sources/pose_path.hpp"
#include "robot_client/sources/source.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

/// Turn the points of a spinning lidar into scans.
namespace scanloom::robot {

/// How readings are used. The defaults are those of an LD06's data sheet unless a comment states another source; other
/// models have theirs in lidar_models.
struct LidarScanOptions {
    double range_min = 0.02; ///< metres; shorter readings are invalid
    double range_max = 12.0; ///< metres; readings of at least this length are no-returns
    NoReturn no_return = NoReturn::kFree;
    /// Readings of less confidence are invalid. In a real recording of a room with a stationary sensor, one in three
    /// readings below 100 lies more than 0.15 m from the median of its half degree, but fewer than 2 in 100 of the
    /// others do; fewer than 1 in 100 readings are below 100.
    std::uint8_t confidence_min = 100;
    std::optional<int> median_window; ///< beams, see median_filtered()
    Pose2 mount;                      ///< T_robot_sensor; the sensor's x axis is its 0 degrees
    Poses poses = Poses::kMap;        ///< what the robot's poses are
};

/// The robot's pose: one pose for all scans, or a timeline of poses. What it is, LidarScanOptions::poses says; with
/// kNone it is one pose, which is not sent.
using LidarPoses = std::variant<Pose2, PoseTimeline>;

/// Applies the limits of LidarScanOptions to readings.
class RangeFilter {
public:
    explicit RangeFilter(const LidarScanOptions& options);

    /// @param distance  millimetres; 0 = no measurement
    [[nodiscard]] RangeMm operator()(std::uint32_t distance) const noexcept {
        static_assert(kInvalidRange == 0, "a distance of 0 is none, whatever the least range is");
        if (distance < min_) return kInvalidRange;
        return distance < max_ ? distance : no_return_;
    }

private:
    RangeMm min_;
    RangeMm max_;
    RangeMm no_return_;
};

/// Returns the description of a spinning sensor for the server.
/// @param name         for people
/// @param usual_beams  of a turn; every scan contains its own angles
[[nodiscard]] std::shared_ptr<const Sensor> lidar_sensor(std::string_view name, std::uint32_t usual_beams,
                                                         const LidarScanOptions& options);

/// Converts a turn into a scan without a pose.
///
/// Beams are in counter-clockwise order. The sensor turns clockwise, so the turn's last point is the first beam. Angles
/// are whole steps, from 0 (excluded) to a full turn. The scan keeps common/scan/limits.hpp. A distance of 0 becomes an
/// invalid beam: the sensor saw nothing or could not measure.
/// @param steps_per_turn  of the steps of its beams
[[nodiscard]] Scan lidar_scan(const LidarTurn& turn, std::int32_t steps_per_turn, const LidarScanOptions& options);

} // namespace scanloom::robot
