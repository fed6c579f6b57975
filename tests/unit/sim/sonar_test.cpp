#include "sim/range_sensors.hpp"

#include "sim/ray_casting.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scanloom::sim {
namespace {

Sensor ring() { return find_sonar("ring16").value(); }

Point2 place_with_clearance(const World& world, Random& random) {
    for (;;) {
        const Box& floor = world.floors[random.index(world.floors.size())];
        const Point2 place{random.uniform(floor.x_min, floor.x_max), random.uniform(floor.y_min, floor.y_max)};
        if (clearance(world, place) > 0.16) return place;
    }
}

TEST(Ring16, HasSixteenConesInAFullCircle) {
    const Sensor sonar = ring();
    EXPECT_EQ(sonar.kind, SensorKind::kSonar);
    EXPECT_EQ(beam_count(sonar.angles), 16U);
    EXPECT_NEAR(beam_angle(sonar.angles, 8), 0.0, 1e-12);
    EXPECT_NEAR(beam_angle(sonar.angles, 12), kPi / 2.0, 1e-12);
    EXPECT_NEAR(sonar.aperture, kPi / 6.0, 1e-12);
    EXPECT_EQ(sonar.range_max, 5.0);
    EXPECT_EQ(sonar.range_min, 0.15);
    EXPECT_EQ(find_sonar("bat").error().message, "unknown sonars 'bat'; choose ring16");
}

/// Returns the smallest distance of a fan of rays, and of rays to every end and perpendicular foot of an outline inside
/// the cone. Each ray is computed separately.
double nearest_ray(const World& world, const Point2& origin, double yaw, double aperture) {
    std::vector<double> directions;
    for (int n = 0; n <= 200; ++n) directions.push_back(yaw + (n / 200.0 - 0.5) * aperture);
    const auto add = [&](double x, double y) {
        const double direction = std::atan2(y - origin.y, x - origin.x);
        if (std::abs(normalize_angle(direction - yaw)) <= aperture / 2.0) directions.push_back(direction);
    };
    for (const Segment& side : world.outlines) {
        add(side.ax, side.ay);
        add(std::clamp(origin.x, std::min(side.ax, side.bx), std::max(side.ax, side.bx)),
            std::clamp(origin.y, std::min(side.ay, side.by), std::max(side.ay, side.by))); // sides are axis-aligned
    }
    double nearest = HUGE_VAL;
    for (const double direction : directions) {
        nearest = std::min(nearest, cast_ray(world.outlines, origin, direction));
        for (const Walker& walker : world.walkers) {
            nearest = std::min(nearest, cast_ray(body_of(walker), origin, direction));
        }
    }
    return nearest;
}

TEST(Listen, MatchesTheNearestRayInsideTheCone) {
    const Sensor sonar = ring();
    Random random(8);
    for (const NamedWorld& named : kWorlds) {
        const World world = named.make();
        for (int i = 0; i < 15; ++i) {
            const Point2 place = place_with_clearance(world, random);
            const Pose2 pose{place.x, place.y, random.uniform(-kPi, kPi)};
            const auto ranges = listen(world, sonar, pose, std::nullopt, random);
            ASSERT_EQ(ranges.size(), 16U);
            for (std::size_t beam = 0; beam < 16; ++beam) {
                const double wanted =
                    nearest_ray(world, place, pose.yaw + beam_angle(sonar.angles, beam), sonar.aperture);
                if (wanted >= 5.0) {
                    ASSERT_EQ(ranges[beam], kNoReturn) << named.name;
                } else {
                    // a walker's nearest point can lie between two rays, which are 0.15 degrees apart
                    ASSERT_NEAR(ranges[beam] / 1000.0, wanted, 0.0015) << named.name << ' ' << i << ' ' << beam;
                }
            }
        }
    }
}

TEST(Listen, NoiseHasItsDeviationAndKeepsNoReturns) {
    const World room = make_room();
    const Sensor sonar = ring();
    Random random(4);
    const Pose2 pose{4.0, -3.2, 0.1};
    double squares = 0.0;
    int count = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto exact = listen(room, sonar, pose, std::nullopt, random);
        const auto noisy = listen(room, sonar, pose, Noise{.beam_angle = 0.0}, random);
        for (std::size_t beam = 0; beam < exact.size(); ++beam) {
            ASSERT_EQ(exact[beam] == kNoReturn, noisy[beam] == kNoReturn);
            if (exact[beam] == kNoReturn || exact[beam] > 4800) continue;
            const double difference = (static_cast<double>(noisy[beam]) - static_cast<double>(exact[beam])) / 1000.0;
            squares += difference * difference;
            ++count;
        }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.001);
}

} // namespace
} // namespace scanloom::sim
