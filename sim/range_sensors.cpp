#include "sim/range_sensors.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/ray_casting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace scanloom::sim {
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
    if (name == "handheld") return make_laser(name, {-180.0 * kDegree, 0.8 * kDegree, 450}, 12.0);
    return Error{Errc::kNotFound,
                 fmt::format("unknown laser '{}'; choose reference, lidar360, wide or handheld", name)};
}

namespace {

RangeMm beam_reading(const World& world, std::span<const Disc> people, const Sensor& laser, std::size_t beam,
                     const Pose2& T_map_laser, const std::optional<Noise>& noise, Random& random) {
    const Point2 origin{T_map_laser.x, T_map_laser.y};
    const double yaw = true_direction(T_map_laser.yaw + beam_angle(laser.angles, beam), noise, random);
    double range = world.obstacles->cast_ray(origin, yaw, laser.range_max);
    for (const Disc& person : people) range = std::min(range, cast_ray(person, origin, yaw));
    return reading(range, laser, noise, random);
}

} // namespace

std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                           const std::optional<Noise>& noise, Random& random) {
    const auto people = people_near(world, {T_map_laser.x, T_map_laser.y}, laser.range_max);
    std::vector<RangeMm> ranges(beam_count(laser.angles));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        ranges[i] = beam_reading(world, people, laser, i, T_map_laser, noise, random);
    }
    return ranges;
}

std::vector<RangeMm> sweep_beams(const World& world, const Sensor& laser, std::size_t first,
                                 std::span<const Pose2> T_map_laser, const std::optional<Noise>& noise,
                                 Random& random) {
    std::vector<RangeMm> ranges;
    ranges.reserve(T_map_laser.size());
    for (const Pose2& pose : T_map_laser) {
        const auto people = people_near(world, {pose.x, pose.y}, laser.range_max);
        ranges.push_back(beam_reading(world, people, laser, first + ranges.size(), pose, noise, random));
    }
    return ranges;
}

namespace {

constexpr double kPi = std::numbers::pi;

/// A cone and the distance in metres of the nearest point found in it so far; initially the sensor's range.
struct Heard {
    Cone cone;
    double nearest;
};

} // namespace

Result<Sensor> find_sonar(std::string_view name) {
    if (name != "ring16") {
        return Error{Errc::kNotFound, fmt::format("unknown sonars '{}'; choose ring16", name)};
    }
    const UniformAngles all_round{-kPi, kPi / 8.0, 16};
    return Sensor{1, SensorKind::kSonar, std::string(name), Pose2{}, all_round, kPi / 6.0, kBodyRadius, 5.0};
}

std::vector<RangeMm> listen(const World& world, const Sensor& sonar, const Pose2& T_map_sonar,
                            const std::optional<Noise>& noise, Random& random) {
    const Point2 origin{T_map_sonar.x, T_map_sonar.y};
    std::vector<Heard> beams;
    for (std::size_t i = 0; i < beam_count(sonar.angles); ++i) {
        const double yaw = true_direction(T_map_sonar.yaw + beam_angle(sonar.angles, i), noise, random);
        beams.push_back({Cone(origin, yaw, sonar.aperture), sonar.range_max});
    }
    const auto hear = [&](const auto& shape) {
        for (Heard& beam : beams) beam.nearest = std::min(beam.nearest, distance_within(beam.cone, shape));
    };
    const auto farthest = [&] { return std::ranges::max_element(beams, {}, &Heard::nearest)->nearest; };
    world.obstacles->outlines().visit_outwards(origin, farthest, hear);
    for (const Disc& person : people_near(world, origin, sonar.range_max)) hear(person);
    std::vector<RangeMm> ranges;
    ranges.reserve(beams.size());
    for (const Heard& beam : beams) ranges.push_back(reading(beam.nearest, sonar, noise, random));
    return ranges;
}

} // namespace scanloom::sim
