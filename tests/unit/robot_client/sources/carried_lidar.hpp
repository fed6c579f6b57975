#pragma once

#include "robot_client/sources/source.hpp"
#include "sim/range_sensors.hpp"
#include "sim/world.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// Two poses in the room, 3 m apart.
inline constexpr Pose2 kHere{-3.5, -3.0, 0.3};
inline constexpr Pose2 kThere{-3.4, 0.0, 0.5};

/// A simulated lidar that a person carries through a world: 360 beams, a range sigma of 0.02 m, ten turns per second.
/// It has no odometry: the pose of each turn is the origin.
class CarriedLidar {
public:
    explicit CarriedLidar(sim::World world = sim::make_room(), std::uint64_t seed = 1)
        : world_(std::move(world)), random_(seed) {}

    [[nodiscard]] Observation turn_at(const Pose2& place) {
        Observation turn{sensor_, {}};
        turn.scan.stamp = stamp_;
        stamp_ += 0.1;
        turn.scan.ranges = sweep(world_, *sensor_, place, sim::Noise{}, random_);
        return turn;
    }

    [[nodiscard]] std::vector<Observation> turns_at(const Pose2& place, std::size_t count) {
        std::vector<Observation> turns;
        for (std::size_t n = 0; n < count; ++n) turns.push_back(turn_at(place));
        return turns;
    }

    /// Returns turns at equal steps on the straight line between two poses, excluding both ends.
    [[nodiscard]] std::vector<Observation> turns_between(const Pose2& a, const Pose2& b, std::size_t count) {
        std::vector<Observation> turns;
        for (std::size_t n = 1; n <= count; ++n) {
            const double part = static_cast<double>(n) / static_cast<double>(count + 1);
            turns.push_back(turn_at(
                {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.yaw + part * normalize_angle(b.yaw - a.yaw)}));
        }
        return turns;
    }

    /// Returns a random pose with a clearance of 0.4 m.
    [[nodiscard]] Pose2 any_place() {
        const sim::Box bounds = bounds_of(world_);
        for (;;) {
            const Pose2 place{random_.uniform(bounds.x_min, bounds.x_max), random_.uniform(bounds.y_min, bounds.y_max),
                              random_.uniform(-3.0, 3.0)};
            if (clearance(world_, {place.x, place.y}) >= 0.4) return place;
        }
    }

    [[nodiscard]] const Sensor& sensor() const noexcept { return *sensor_; }
    [[nodiscard]] sim::World& world() noexcept { return world_; }
    [[nodiscard]] sim::Random& random() noexcept { return random_; }
    void let_time_pass(double seconds) noexcept { stamp_ += seconds; }

private:
    sim::World world_;
    sim::Random random_;
    std::shared_ptr<const Sensor> sensor_ = std::make_shared<const Sensor>(*sim::find_laser("lidar360"));
    double stamp_ = 1000.0;
};

} // namespace scanloom::robot
