#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <istream>
#include <optional>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// The robot's pose at one time, as recorded.
struct StampedPose {
    Pose2 robot;
    double stamp = 0.0; ///< seconds, finite
};

/// Makes a stamped pose; its yaw, in radians, may exceed a full turn.
/// Errors: kInvalidField if it is beyond kCoordinateMax.
[[nodiscard]] Result<StampedPose> stamped_pose(double x, double y, double yaw, double stamp);

/// Interpolates between two poses, or extrapolates, with constant velocity and the shorter direction of turning.
/// @return `from` if both have the same stamp
[[nodiscard]] Pose2 interpolate(const StampedPose& from, const StampedPose& to, double stamp);

/// A scan that is farther than this in time from the nearest recorded pose has no pose.
inline constexpr double kPoseGapMax = 1.0; // seconds

/// The poses of a recording whose scans contain none.
class PosePath {
public:
    PosePath() = default;
    explicit PosePath(std::vector<StampedPose> samples);

    /// Interpolates between the samples around `stamp`; returns nullopt if none is within kPoseGapMax.
    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

private:
    std::vector<StampedPose> samples_; // by increasing stamp
};

/// Poses that arrive over time. Unlike PosePath it interpolates only between its poses, however far apart they are: the
/// sender of poses also defines the trajectory between them.
class PoseTimeline {
public:
    /// Adds a pose. Poses may arrive in any order.
    void insert(const StampedPose& pose);

    /// Removes the oldest poses beyond `count`.
    void keep_newest(std::size_t count);

    /// Removes the poses later than `stamp`.
    void forget_after(double stamp);

    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

    [[nodiscard]] bool empty() const noexcept { return poses_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return poses_.size(); }
    [[nodiscard]] auto begin() const noexcept { return poses_.begin(); }
    [[nodiscard]] auto end() const noexcept { return poses_.end(); }
    /// Pre: not empty.
    [[nodiscard]] const StampedPose& oldest() const noexcept { return poses_.front(); }
    [[nodiscard]] const StampedPose& newest() const noexcept { return poses_.back(); }

private:
    std::deque<StampedPose> poses_; // by increasing stamp
};

/// Parses one line of poses: `t x y yaw` in seconds, metres and radians counter-clockwise. The yaw may exceed a full
/// turn, as odometry counts it. Text after these values is ignored.
/// @return nullopt for a blank line or one that begins with '#'
/// Errors: kMalformed or kInvalidField if the line is not as above, not finite, or beyond kCoordinateMax.
[[nodiscard]] Result<std::optional<StampedPose>> read_pose_line(std::string_view line);

struct PoseLines {
    PoseTimeline poses;
    std::size_t skipped = 0; ///< lines that could not be used
};

/// Reads a whole file of such lines.
/// @param report  called for each line that cannot be used
/// Errors: those of LineReader; kNotFound if no line is usable.
[[nodiscard]] Result<PoseLines> read_pose_lines(const std::filesystem::path& path,
                                                const std::function<void(const SkippedLine&)>& report,
                                                LineLimits limits = {});

/// Reads a whole stream of such lines. `name` identifies it in messages. Errors: kNotFound if no line is usable.
[[nodiscard]] Result<PoseLines> read_pose_lines(std::istream& lines, std::string_view name,
                                                const std::function<void(const SkippedLine&)>& report);

} // namespace scanloom::robot
