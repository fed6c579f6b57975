#include "core/localization/known_map.hpp"
#include "core/localization/localized_projection.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace scanloom::localization {
namespace {

using testing_support::Building;

constexpr double kCell = 0.05;  // metres
constexpr double kLeft = -10.0; // metres: where the building is in the imported map
constexpr double kLow = 3.0;

/// The map of ring_building() as another program would have made it: its corner is at (kLeft, kLow).
MapPatch ring_map() {
    const Building building = slam::ring_building();
    MapPatch patch{kCell, kLeft - 1.0, kLow - 1.0, 720, {}};
    patch.cells.assign(std::size_t{720} * 480, MapCell::kUnknown);
    const auto cell_at = [&](double x, double y) -> MapCell& {
        const auto column = static_cast<std::size_t>((x + 1.0) / kCell);
        const auto row = static_cast<std::size_t>((y + 1.0) / kCell);
        return patch.cells[row * patch.width + column];
    };
    for (double y = kCell / 2.0; y < 22.0; y += kCell) {
        for (double x = kCell / 2.0; x < 34.0; x += kCell) {
            if (x < 2.0 || x > 32.0 || y < 2.0 || y > 20.0) cell_at(x, y) = MapCell::kFree;
        }
    }
    for (const auto& [from, to] : building.walls) {
        for (int n = 0; n <= 10'000; ++n) {
            const double part = n / 10'000.0;
            cell_at(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)) = MapCell::kOccupied;
        }
    }
    return patch;
}

double distance_to_wall(const Building& building, const Point2& place) {
    double least = 1e9;
    for (const auto& [from, to] : building.walls) {
        const double x = to.x - from.x;
        const double y = to.y - from.y;
        const double along = ((place.x - from.x) * x + (place.y - from.y) * y) / (x * x + y * y);
        const double part = std::clamp(along, 0.0, 1.0);
        least = std::min(least, std::hypot(place.x - from.x - part * x, place.y - from.y - part * y));
    }
    return least;
}

LocalizedProjection imported() {
    mapping::Projection maps{mapping::MapConfig()};
    EXPECT_TRUE(maps.apply(ring_map()));
    return maps;
}

TEST(KnownMap, ViewsAreWhatALaserSeesThere) {
    auto maps = imported();
    const auto views = views_of(maps.projection().snapshot().classes, kCell);
    EXPECT_GT(views.size(), 30U);
    EXPECT_LT(views.size(), 120U);
    const Building building = slam::ring_building();
    for (const auto& [T_map_laser, points] : views) {
        const Point2 place{T_map_laser.x - kLeft, T_map_laser.y - kLow};
        const bool is_in_block = place.x > 2.0 && place.x < 32.0 && place.y > 2.0 && place.y < 20.0;
        ASSERT_TRUE(!is_in_block && place.x > 0.2 && place.x < 33.8 && place.y > 0.2 && place.y < 21.8);
        for (const auto& point : points.points) {
            ASSERT_LT(distance_to_wall(building, {place.x + point.x, place.y + point.y}), 2.0 * kCell);
        }
    }
}

TEST(KnownMap, AnEmptyMapHasNoViews) {
    mapping::Projection maps{mapping::MapConfig()};
    EXPECT_TRUE(views_of(maps.snapshot().classes, kCell).empty());
}

/// The frame of the map is that of the imported map, and the robot starts anywhere in it.
TEST(KnownMap, ARobotIsLocatedInAnImportedMap) {
    const slam::Drive drive = slam::drive_along(
        slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 6.0}}, {.scale = 1.02}, 1);
    auto maps = imported();
    std::vector<LogEntry> log{RobotJoined{0, "robot", {}, {}, Poses::kOdometry}, SensorDescribed{0, drive.laser}};
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.seq = n + 1;
        scan.pose.reset();
        scan.odometry = drive.odometry[n];
        log.push_back(ScanTaken{0, scan});
    }
    for (LogEntry& entry : log) {
        double work = HUGE_VAL;
        ASSERT_TRUE(maps.apply(entry, work).value());
    }
    const auto* poses = maps.poses().find(0);
    ASSERT_EQ(poses->localization().state, LocalizationState::kTracking);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        const Pose2 pose = poses->newest(n);
        ASSERT_LT(std::hypot(pose.x - kLeft - drive.truth[n].x, pose.y - kLow - drive.truth[n].y), 0.15) << n;
    }
    EXPECT_TRUE(maps.is_outdated()) << "its scans are not in the maps yet, which showed none of them";
}

} // namespace
} // namespace scanloom::localization
