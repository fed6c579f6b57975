#include "lab/recording.hpp"

#include "robot_client/drive/wall_follower.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace scanloom::lab {

robot::World world_of(std::string_view name) {
    robot::World world = robot::find_world(name).value();
    const auto move = [](std::vector<robot::Box> boxes) {
        for (robot::Box& box : boxes) {
            box = {box.x_min + kRoomMiddle.x, box.y_min + kRoomMiddle.y, box.x_max + kRoomMiddle.x,
                   box.y_max + kRoomMiddle.y};
        }
        return boxes;
    };
    robot::World moved = robot::make_world(world.name, move(world.solids), move(world.floors));
    moved.walkers = std::move(world.walkers);
    for (robot::Walker& walker : moved.walkers) {
        for (Point2& corner : walker.loop) corner += kRoomMiddle;
    }
    return moved;
}

Sensor reference_laser() { return robot::find_laser("reference").value(); }

std::vector<Pose2> drive_from(const Start& start, std::size_t scans) {
    robot::Simulator simulator({world_of("room"), reference_laser(), std::nullopt, 1, start.pose},
                               std::make_unique<robot::WallFollower>());
    std::vector<Pose2> path(scans);
    std::generate(path.begin(), path.end(), [&] { return simulator.next_scan().pose; });
    return path;
}

namespace {

/// Returns how many beams end at a walker: those whose range differs without walkers.
std::size_t readings_of_walkers(const robot::World& world, const Sensor& laser, const Pose2& pose) {
    if (world.walkers.empty()) return 0;
    robot::World without = world;
    without.walkers.clear();
    robot::Random unused(1);
    const auto seen = robot::sweep(world, laser, pose, std::nullopt, unused);
    const auto behind = robot::sweep(without, laser, pose, std::nullopt, unused);
    return std::inner_product(seen.begin(), seen.end(), behind.begin(), std::size_t{0}, std::plus<>(),
                              std::not_equal_to<>());
}

} // namespace

Recording record(const Scene& scene, const std::vector<Pose2>& path, const NoiseChoice& noise, double cell_size_m,
                 std::uint64_t seed) {
    robot::World world = world_of(scene.world);
    robot::Random random(seed);
    Recording recording{reference_laser(), {}, {}, 0};
    for (const Pose2& pose : path) {
        if (!recording.scans.empty()) robot::walk(world, {pose.x, pose.y}, robot::kScanPeriod);
        Scan scan;
        scan.seq = recording.scans.size() + 1;
        scan.stamp = static_cast<double>(recording.scans.size()) * robot::kScanPeriod;
        scan.sensor = recording.laser.id;
        scan.pose = pose;
        scan.ranges = robot::sweep(world, recording.laser, pose, noise.at(cell_size_m), random);
        if (noise.drops_no_return) std::replace(scan.ranges.begin(), scan.ranges.end(), kNoReturn, kInvalidRange);
        recording.scans.push_back(std::move(scan));
        recording.of_walkers += readings_of_walkers(world, recording.laser, pose);
        auto& bodies = recording.walkers.emplace_back();
        for (const robot::Walker& walker : world.walkers) bodies.push_back(robot::body_of(walker));
    }
    return recording;
}

} // namespace scanloom::lab
