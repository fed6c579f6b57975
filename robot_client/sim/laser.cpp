#include "robot_client/sim/laser.hpp"

#include "robot_client/sim/ray_casting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRangeMin = 0.02;

Sensor make_laser(std::string_view name, UniformAngles angles, double range_max) {
    return {0, SensorKind::kLaser, std::string(name), Pose2{}, angles, 0.0, kRangeMin, range_max};
}

} // namespace

Result<Sensor> find_laser(std::string_view name) {
    if (name == "reference") return make_laser(name, {-90.0 * kDegree, 180.0 * kDegree / 683.0, 684}, 5.0);
    if (name == "lidar360") return make_laser(name, {-180.0 * kDegree, kDegree, 360}, 12.0);
    if (name == "wide") return make_laser(name, {-135.0 * kDegree, 0.25 * kDegree, 1081}, 30.0);
    return Error{Errc::kNotFound, fmt::format("unknown laser '{}'; choose reference, lidar360 or wide", name)};
}

std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                           const std::optional<Noise>& noise, Random& random) {
    const Point2 origin{T_map_laser.x, T_map_laser.y};
    const auto people = people_near(world, origin, laser.range_max);
    std::vector<RangeMm> ranges(beam_count(laser.angles));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const double yaw = true_direction(T_map_laser.yaw + beam_angle(laser.angles, i), noise, random);
        double range = world.obstacles->cast_ray(origin, yaw, laser.range_max);
        for (const Disc& person : people) range = std::min(range, cast_ray(person, origin, yaw));
        ranges[i] = reading(range, laser, noise, random);
    }
    return ranges;
}

} // namespace scanloom::robot
