#include "tests/bench/localization/drives.hpp"

#include "robot_client/sources/carmen_log.hpp"
#include "sim/drive/wall_follower.hpp"
#include "sim/range_sensors.hpp"
#include "sim/simulator.hpp"

#include <memory>
#include <utility>

namespace scanloom::bench {

Result<LaserDrive> drive_of_log(const std::string& file, Poses poses, std::size_t most) {
    robot::CarmenOptions options;
    options.poses = poses;
    auto log = robot::CarmenLog::open(file, options, [](const robot::SkippedLine&) {});
    if (!log) return log.error();
    LaserDrive drive;
    std::shared_ptr<const Sensor> laser;
    while (drive.scans.size() < most) {
        auto observation = log->next();
        if (!observation) return observation.error();
        if (!*observation) break;
        auto& [sensor, scan] = **observation;
        if (laser && *sensor != *laser) return Error{Errc::kConflict, "the log is of several lasers; use another one"};
        laser = sensor;
        scan.seq = drive.scans.size() + 1;
        drive.scans.push_back(std::move(scan));
    }
    if (!laser) return Error{Errc::kNotFound, "the log has no laser scans; use another one"};
    drive.laser = *laser;
    return drive;
}

LaserDrive simulated_drive(Poses poses, std::size_t driving, std::size_t standing) {
    sim::SimulatorOptions options;
    options.world = sim::find_world("office").value();
    options.laser = sim::find_laser("lidar360").value();
    options.noise = sim::Noise{};
    options.poses = poses;
    sim::Simulator simulator(std::move(options), std::make_unique<sim::WallFollower>());
    LaserDrive drive{*simulator.sensors().front(), {}};
    for (std::size_t n = 0; n < driving; ++n) drive.scans.push_back(simulator.next_scan());
    sim::Random random(2);
    for (std::size_t n = 0; n < standing; ++n) {
        Scan scan = drive.scans.back();
        scan.stamp += sim::kScanPeriod;
        scan.ranges = sim::sweep(simulator.world(), drive.laser, simulator.pose(), sim::Noise{}, random);
        drive.scans.push_back(std::move(scan));
    }
    for (std::size_t n = 0; n < drive.scans.size(); ++n) drive.scans[n].seq = n + 1;
    return drive;
}

} // namespace scanloom::bench
