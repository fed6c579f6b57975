#include "sim/range_sensors.hpp"

#include "sim/ray_casting.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::sim {
namespace {

TEST(Lasers, BeamAnglesMatchTheirDescription) {
    const auto ends = [](const char* name) {
        const Sensor laser = *find_laser(name);
        const std::size_t count = beam_count(laser.angles);
        return std::array{static_cast<double>(count), beam_angle(laser.angles, 0) / kDegree,
                          beam_angle(laser.angles, count - 1) / kDegree, laser.range_max};
    };
    const auto expect = [](std::array<double, 4> actual, std::array<double, 4> wanted) {
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(actual[i], wanted[i], 1e-9);
    };
    expect(ends("reference"), {684, -90, 90, 5});
    expect(ends("lidar360"), {360, -180, 179, 12});
    expect(ends("wide"), {1081, -135, 135, 30});
    expect(ends("handheld"), {450, -180, 179.2, 12});
    EXPECT_FALSE(find_laser("radar"));
}

TEST(Sweep, IsExactToTheMillimetreWithoutNoise) {
    const World room = make_room();
    const Sensor laser = *find_laser("wide");
    Random random(1);
    const Pose2 pose{-3.0, -2.0, 0.7};
    const auto ranges = sweep(room, laser, pose, std::nullopt, random);
    ASSERT_EQ(ranges.size(), 1081U);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const double exact = cast_ray(room.outlines, {pose.x, pose.y}, pose.yaw + beam_angle(laser.angles, i));
        EXPECT_NEAR(ranges[i] / 1000.0, exact, 0.0005000001);
    }
}

TEST(Sweep, NoiseHasItsDeviationAndKeepsNoReturns) {
    const World room = make_room();
    const Sensor laser = *find_laser("reference");
    Random random(4);
    const Pose2 pose{4.0, 0.0, 0.0}; // a wall 1 m ahead
    double squares = 0.0;
    int count = 0;
    for (int i = 0; i < 200; ++i) {
        const auto exact = sweep(room, laser, pose, std::nullopt, random);
        const auto noisy = sweep(room, laser, pose, Noise{.beam_angle = 0.0}, random);
        for (std::size_t beam = 0; beam < exact.size(); ++beam) {
            ASSERT_EQ(exact[beam] == kNoReturn, noisy[beam] == kNoReturn);
            if (exact[beam] == kNoReturn || exact[beam] > 4800) continue; // the range truncates this noise
            const double difference = (static_cast<double>(noisy[beam]) - static_cast<double>(exact[beam])) / 1000.0;
            squares += difference * difference;
            ++count;
        }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.001);
}

TEST(Sweep, UniformNoiseIncreasesReadingsUpToItsWidth) {
    const World room = make_room();
    const Sensor laser = *find_laser("reference");
    Random random(6);
    const Pose2 pose{4.0, 0.0, 0.0};
    const Noise noise{.range = 0.0, .range_uniform = 0.3, .beam_angle = 0.0};
    double sum = 0.0;
    double largest = 0.0;
    int count = 0;
    for (int i = 0; i < 100; ++i) {
        const auto exact = sweep(room, laser, pose, std::nullopt, random);
        const auto noisy = sweep(room, laser, pose, noise, random);
        for (std::size_t beam = 0; beam < exact.size(); ++beam) {
            if (exact[beam] == kNoReturn || exact[beam] > 4600) continue;
            const double excess = (static_cast<double>(noisy[beam]) - static_cast<double>(exact[beam])) / 1000.0;
            EXPECT_GT(excess, -0.0011);
            sum += excess;
            largest = std::max(largest, excess);
            ++count;
        }
    }
    EXPECT_NEAR(sum / count, 0.15, 0.003);
    EXPECT_NEAR(largest, 0.3, 0.002);
}

TEST(Sweep, DetectsAWalkerInFrontOfAWall) {
    World world = make_room();
    world.walkers = {{.loop = {{3.0, 3.0}, {4.0, 3.0}}, .radius = 0.25}};
    Sensor laser = *find_laser("reference");
    laser.angles = UniformAngles{0.0, 0.1, 1};
    Random random(1);
    EXPECT_EQ(sweep(world, laser, {3.0, 4.5, -std::numbers::pi / 2.0}, std::nullopt, random).at(0), 1250U);
    EXPECT_EQ(sweep(world, laser, {1.5, 3.0, 0.0}, std::nullopt, random).at(0), 1250U);
    walk(world, {-4.0, -4.0}, 0.5);
    EXPECT_EQ(sweep(world, laser, {1.5, 3.0, 0.0}, std::nullopt, random).at(0), 1750U) << "the walker has moved on";
    laser.range_max = 1.5;
    EXPECT_EQ(sweep(world, laser, {1.5, 3.0, 0.0}, std::nullopt, random).at(0), kNoReturn);
}

} // namespace
} // namespace scanloom::sim
