#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <numbers>
#include <random>
#include <vector>

/// A robot's stream of scans that is a function of the seed. Its readings show no consistent place, but fill a map.
namespace scanloom::testing_support {

inline Sensor small_laser() {
    Sensor sensor;
    sensor.id = 2;
    sensor.name = "laser";
    sensor.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 18, 18};
    sensor.range_max = 4.0;
    return sensor;
}

/// Returns scan `seq` of the robot with this seed, measured by small_laser().
inline Scan random_scan(unsigned seed, std::uint64_t seq) {
    std::mt19937 random(seed * 1'000'003U + static_cast<unsigned>(seq));
    std::uniform_real_distribution<double> metres(-8.0, 8.0);
    Scan scan;
    scan.seq = seq;
    scan.stamp = static_cast<double>(seq) * 0.1;
    scan.sensor = small_laser().id;
    scan.pose = Pose2{};
    scan.pose->x = metres(random);
    scan.pose->y = metres(random);
    scan.pose->yaw = normalize_angle(metres(random));
    for (int beam = 0; beam < 18; ++beam) scan.ranges.push_back(static_cast<RangeMm>(random() % 4500));
    return scan;
}

inline std::vector<Scan> random_scans(unsigned seed, std::uint64_t first_seq, std::size_t count) {
    std::vector<Scan> scans;
    for (std::size_t n = 0; n < count; ++n) scans.push_back(random_scan(seed, first_seq + n));
    return scans;
}

} // namespace scanloom::testing_support
