#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

namespace scanloom::robot {

/// Finds out whether scans contradict their poses: whether walls are where earlier scans saw free space, and not where
/// earlier scans saw walls, as in the map of a robot whose poses are drifting odometry. Looks at some beams of scans
/// 0.5 m apart, in cells of 0.2 m, and compares them with scans at least 10 m of travel before.
/// Memory: about 48 bytes for each cell, at most 50 MB; then new places are not looked at.
/// Threads: one at a time.
class PoseCheck {
public:
    /// Adds the next scan. Scans of sonars and scans without a pose do not count.
    /// @param scan    with T_map_robot
    /// @param sensor  that took it
    void add(const Scan& scan, const Sensor& sensor);

    /// Returns whether the scans contradict their poses; false until enough places were seen again.
    [[nodiscard]] bool looks_like_odometry() const noexcept;

    /// Returns the share of hits that contradict earlier scans, of those where earlier scans show something. 0 to 1.
    [[nodiscard]] double contradicted_share() const noexcept;

private:
    /// When a cell was first seen, in metres travelled; a large number: never.
    struct Cell {
        float hit = 1e30F;
        float passed = 1e30F;
    };

    [[nodiscard]] bool was_hit_near(std::int32_t column, std::int32_t row, float until) const;
    void compare(const Point2& hit);
    void draw(const Point2& laser, const Point2& hit);
    [[nodiscard]] Cell* cell_at(std::int32_t column, std::int32_t row);

    std::unordered_map<std::uint64_t, Cell> cells_;
    std::optional<Pose2> last_; // of the last scan that was looked at
    float travelled_ = 0.0F;    // metres; a turn of one radian counts as one metre
    std::size_t agreed_ = 0;    // hits
    std::size_t contradicted_ = 0;
};

/// A recording whose poses in the map frame are checked, if it has any. Its remarks say if they look like odometry.
/// Threads: as for Source.
class CheckedPoses final : public Source {
public:
    /// @param source  of any kind of poses
    explicit CheckedPoses(std::unique_ptr<Source> source) : source_(std::move(source)) {}

    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return source_->scan_count(); }
    [[nodiscard]] std::string remarks() const override;

private:
    std::unique_ptr<Source> source_;
    PoseCheck check_;
};

} // namespace scanloom::robot
