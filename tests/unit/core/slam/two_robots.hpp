#pragma once

#include "tests/unit/core/slam/drive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// How the second of TwoRobots differs from the first.
struct SecondRobot {
    bool is_frozen = false;   ///< whether the map is frozen before it starts
    bool has_odometry = true; ///< whether its estimator gets the odometry of its drive
};

/// Two robots that share a map. The second one starts when the first has ended.
class TwoRobots {
public:
    TwoRobots(const Drive& first, const Drive& second, const SecondRobot& how = {}) : first_(first), second_(second) {
        for (std::size_t n = 0; n < first.scans.size(); ++n)
            a_.add(scan_matching::points_of(first.scans[n], first.laser), first.odometry[n]);
        if (how.is_frozen) {
            a_.finish();
            map_.freeze(true);
            before_.assign(map_.graph().poses().begin(), map_.graph().poses().end());
        }
        for (std::size_t n = 0; n < second.scans.size(); ++n) {
            b_.add(scan_matching::points_of(second.scans[n], second.laser),
                   how.has_odometry ? std::optional(second.odometry[n]) : std::nullopt);
            if (!located_at_ && b_.located_fragments() > 0) located_at_ = n;
        }
        a_.finish();
        b_.finish();
        map_.finish();
    }

    /// Returns the scan of the second robot at which it was located.
    [[nodiscard]] std::optional<std::size_t> located_at() const { return located_at_; }

    /// Returns the largest error_of() of the second robot's scans, metres.
    [[nodiscard]] double largest_error() const {
        double largest = 0.0;
        for (std::size_t n = 0; n < second_.truth.size(); ++n) largest = std::max(largest, error_of(n));
        return largest;
    }

    /// Returns the distance of a pose of the second robot from the true one, metres, in the frame of the first robot's
    /// pose that is nearest.
    [[nodiscard]] double error_of(std::size_t scan) const {
        std::size_t nearest = 0;
        const auto distance = [&](std::size_t k) {
            return std::hypot(first_.truth[k].x - second_.truth[scan].x, first_.truth[k].y - second_.truth[scan].y);
        };
        for (std::size_t k = 1; k < first_.truth.size(); ++k) {
            if (distance(k) < distance(nearest)) nearest = k;
        }
        const Pose2 truth = compose(inverse(first_.truth[nearest]), second_.truth[scan]);
        const Pose2 found = compose(inverse(a_.pose_of(nearest)), b_.pose_of(scan));
        return std::hypot(truth.x - found.x, truth.y - found.y);
    }

    /// Returns the poses of the keyframes when the map was frozen.
    [[nodiscard]] const std::vector<Transform2>& before() const { return before_; }

    [[nodiscard]] const TrajectoryEstimator& second() const { return b_; }
    [[nodiscard]] const SharedMap& map() const { return map_; }

private:
    const Drive& first_;
    const Drive& second_;
    SharedMap map_;
    TrajectoryEstimator a_{map_, 0};
    TrajectoryEstimator b_{map_, 1};
    std::optional<std::size_t> located_at_;
    std::vector<Transform2> before_;
};

} // namespace scanloom::slam
