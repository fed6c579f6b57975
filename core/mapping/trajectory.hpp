#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "core/mapping/growing_list.hpp"

#include <cstddef>
#include <utility>

namespace scanloom::mapping {

/// A robot's pose at one of its scans.
struct TrajectoryPoint {
    Revision revision = 0; ///< of the scan's log entry
    double stamp = 0.0;    ///< seconds, of the scan
    Pose2 pose;            ///< T_map_robot

    friend bool operator==(const TrajectoryPoint&, const TrajectoryPoint&) = default;
};

/// The number of newest points that a trajectory keeps at least: minutes of a robot that scans at 10 Hz. Limits the
/// memory of a robot that runs for long; the log contains all points.
inline constexpr std::size_t kTrajectoryKept = 16 * kListBlock;

/// The points of a trajectory at one moment, by increasing revision.
///
/// Point n belongs to the robot's scan n, counted from 0. Points before begin() are only in the log.
class TrajectoryView : public ListView<TrajectoryPoint> {
public:
    TrajectoryView() = default;
    /// Creates a view of these points.
    explicit TrajectoryView(ListView<TrajectoryPoint> points) : ListView(std::move(points)) {}

    /// Returns the index of the first point that is kept and newer than `since`; size() if there is none.
    /// @param since  revision of a log entry
    [[nodiscard]] std::size_t first_after(Revision since) const noexcept {
        std::size_t low = begin();
        std::size_t high = size();
        while (low < high) {
            const std::size_t middle = low + (high - low) / 2;
            if ((*this)[middle].revision > since) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        return low;
    }
};

/// The newest points of a growing list of poses.
/// Threads: one writer.
class Trajectory {
public:
    /// @param before  number of earlier points, which it does not keep
    explicit Trajectory(std::size_t before = 0) : points_(before, kTrajectoryKept) {}

    /// Adds a point. Pre: its revision is greater than that of the newest point.
    void append(const TrajectoryPoint& point) { points_.append(point); }

    /// Returns the number of blocks that are kept.
    [[nodiscard]] std::size_t block_count() const noexcept { return points_.block_count(); }

    /// Returns the current points. Points appended later are not in the view.
    [[nodiscard]] TrajectoryView snapshot() const { return TrajectoryView(points_.snapshot()); }

    /// Returns a second trajectory with the same points and its own writer.
    [[nodiscard]] Trajectory branch() const { return Trajectory(points_.branch()); }

private:
    explicit Trajectory(GrowingList<TrajectoryPoint> points) : points_(std::move(points)) {}

    GrowingList<TrajectoryPoint> points_;
};

} // namespace scanloom::mapping
