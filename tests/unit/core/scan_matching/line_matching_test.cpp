#include "core/scan_matching/line_matching.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

namespace scanloom::scan_matching {
namespace {

using testing_support::Building;
using testing_support::uniform;

/// A room with some boxes, and a scan of it that is to be matched to three others.
struct Scene {
    explicit Scene(std::mt19937& random) {
        building.add_box(-uniform(random, 3.0, 6.0), -uniform(random, 2.0, 5.0), uniform(random, 3.0, 6.0),
                         uniform(random, 2.0, 5.0));
        for (int n = 0; n < 3; ++n) {
            const double x = uniform(random, 1.0, 2.0) * (n % 2 == 0 ? 1.0 : -1.0);
            const double y = uniform(random, 1.0, 1.8) * (n < 2 ? 1.0 : -1.0);
            building.add_box(x, y, x + uniform(random, 0.2, 0.8), y + uniform(random, 0.1, 0.2));
        }
        for (int n = 0; n < 3; ++n) {
            const Pose2 pose{uniform(random, -0.7, 0.7), uniform(random, -0.7, 0.7), uniform(random, -0.7, 0.7)};
            shown.push_back(points_of(building.scan(laser, pose, 0.01, random), laser));
            poses.push_back(transform_of(pose));
        }
        std::vector<View> views;
        for (std::size_t n = 0; n < 3; ++n) views.push_back({poses[n], shown[n].points});
        map = PointMap(views);
        truth = {uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5)};
        points = points_of(building.scan(laser, truth, 0.01, random), laser).points;
    }

    Building building;
    Sensor laser = Building::laser();
    std::vector<ScanPoints> shown;
    std::vector<Transform2> poses;
    PointMap map;
    Pose2 truth;
    std::vector<SurfacePoint> points;
};

/// What match_to_lines() minimises with its last gate and scale, without a prior, written independently.
double cost(const Scene& scene, const Pose2& pose) {
    double sum = 0.0;
    for (const auto& point : scene.points) {
        const auto moved = transform(transform_of(pose), point);
        const auto near = scene.map.nearest(moved, 0.2F);
        double residual2 = 1e9;
        if (near.point != nullptr) {
            residual2 = near.squared_distance;
            const SurfacePoint& line = near.point->has_normal() ? *near.point : moved;
            if (line.has_normal()) {
                residual2 =
                    std::pow(line.normal_x * (near.point->x - moved.x) + line.normal_y * (near.point->y - moved.y), 2);
            }
        }
        sum += residual2 / (0.06 * 0.06 + residual2);
    }
    return sum;
}

TEST(LineMatching, FindsTheMinimumOfAnExhaustiveSearch) {
    std::mt19937 random(1);
    for (int round = 0; round < 6; ++round) {
        const Scene scene(random);
        const Pose2 start{scene.truth.x + uniform(random, -0.15, 0.15), scene.truth.y + uniform(random, -0.15, 0.15),
                          scene.truth.yaw + uniform(random, -0.08, 0.08)};
        const auto match =
            match_to_lines(scene.points, scene.map, transform_of(start), {transform_of(start), 10.0, 10.0}, {});
        const Pose2 found = pose_of(match.T_map_robot);
        Pose2 best = scene.truth;
        double least = cost(scene, best);
        for (double x = -0.15; x <= 0.15; x += 0.025) {
            for (double y = -0.15; y <= 0.15; y += 0.025) {
                for (double yaw = -0.1; yaw <= 0.1; yaw += 0.0125) {
                    const Pose2 pose{scene.truth.x + x, scene.truth.y + y, scene.truth.yaw + yaw};
                    const double here = cost(scene, pose);
                    if (here >= least) continue;
                    least = here;
                    best = pose;
                }
            }
        }
        EXPECT_LE(cost(scene, found), least * 1.15 + 0.5) << round;
        EXPECT_NEAR(found.x, best.x, 0.025) << round;
        EXPECT_NEAR(found.y, best.y, 0.025) << round;
        EXPECT_NEAR(found.yaw, best.yaw, 0.0125) << round;
        EXPECT_NEAR(found.x, scene.truth.x, 0.02) << round;
        EXPECT_NEAR(found.y, scene.truth.y, 0.02) << round;
        EXPECT_GT(match.inlier_ratio, 0.7);
        EXPECT_GT(match.conditioning, 0.05);
    }
}

TEST(LineMatching, PriorDeterminesThePositionAlongACorridor) {
    Building corridor;
    corridor.walls = {{{-50.0, -1.0}, {50.0, -1.0}}, {{-50.0, 1.0}, {50.0, 1.0}}};
    const Sensor laser = Building::laser();
    std::mt19937 random(2);
    const auto old = points_of(corridor.scan(laser, {0.0, 0.0, 0.0}, 0.0, random), laser);
    const View view{Transform2(), old.points};
    const PointMap map(std::span(&view, 1));
    const auto points = points_of(corridor.scan(laser, {0.5, 0.2, 0.1}, 0.0, random), laser).points;
    const auto prior = transform_of({0.37, 0.12, 0.05});
    const auto match = match_to_lines(points, map, prior, {prior, 0.05, 0.1}, {});
    EXPECT_NEAR(match.T_map_robot.x, 0.37, 0.05) << "nothing but the prior determines it";
    EXPECT_NEAR(match.T_map_robot.y, 0.2, 0.01);
    EXPECT_NEAR(yaw_of(match.T_map_robot), 0.1, 0.01);
    EXPECT_LT(match.conditioning, 0.01);
}

TEST(LineMatching, OutliersOfAQuarterOfTheBeamsDoNotChangeThePose) {
    std::mt19937 random(3);
    Scene scene(random);
    for (std::size_t n = 0; n < scene.points.size(); n += 4) { // a quarter of the beams hits something else
        scene.points[n].x *= 0.95F;
        scene.points[n].y *= 0.95F;
    }
    const auto start = transform_of({scene.truth.x + 0.1, scene.truth.y - 0.1, scene.truth.yaw + 0.05});
    const auto match = match_to_lines(scene.points, scene.map, start, {start, 0.2, 0.2}, {});
    EXPECT_NEAR(match.T_map_robot.x, scene.truth.x, 0.02);
    EXPECT_NEAR(match.T_map_robot.y, scene.truth.y, 0.02);
    EXPECT_NEAR(yaw_of(match.T_map_robot), scene.truth.yaw, 0.01);
}

TEST(LineMatching, WithoutPointsOrMapThePriorRemains) {
    const auto start = transform_of({1.0, 2.0, 0.5});
    const auto prior = transform_of({1.1, 2.1, 0.6});
    const auto match = match_to_lines({}, PointMap(), start, {prior, 0.1, 0.1}, {});
    EXPECT_NEAR(match.T_map_robot.x, 1.1, 1e-9);
    EXPECT_NEAR(yaw_of(match.T_map_robot), 0.6, 1e-9);
    EXPECT_EQ(match.inlier_ratio, 0.0);
    EXPECT_EQ(match.conditioning, 0.0);
}

TEST(LineMatching, AFailureReturnsTheStart) {
    std::mt19937 random(4);
    const Scene scene(random);
    const auto start = transform_of({0.0, 0.0, 0.0});
    const auto far = match_to_lines(scene.points, PointMap(), start, {transform_of({5.0, 0.0, 0.0}), 0.1, 0.1}, {});
    EXPECT_FALSE(far.is_refined);
    EXPECT_EQ(far.T_map_robot, start);
    EXPECT_TRUE(
        match_to_lines(scene.points, scene.map, transform_of(scene.truth), {transform_of(scene.truth)}, {}).is_refined);
}

} // namespace
} // namespace scanloom::scan_matching
