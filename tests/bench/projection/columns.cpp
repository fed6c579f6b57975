#include "tests/bench/projection/columns.hpp"

#include "sim/range_sensors.hpp"
#include "sim/world.hpp"
#include "tests/support/whole_log.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace scanloom::bench {
namespace {

constexpr std::size_t kScans = 200;

double half_side_of(const std::vector<Scan>& scans, double range_max) {
    double farthest = 0.0;
    for (const Scan& scan : scans) farthest = std::max({farthest, std::abs(scan.pose->x), std::abs(scan.pose->y)});
    return farthest + range_max + 1.0;
}

/// Returns scans from places all over the world, each with free space around it, in all directions.
Column simulated(const std::string& world_name, const std::string& laser, double cell_size, bool is_noisy = false) {
    const auto world = sim::find_world(world_name).value();
    Column column{world_name + (is_noisy ? "+noise" : "") + "/" + std::to_string(cell_size).substr(0, 4),
                  cell_size,
                  sim::find_laser(laser).value(),
                  {},
                  0.0};
    sim::Random random(1);
    const auto box = sim::bounds_of(world);
    while (column.scans.size() < kScans) {
        const Pose2 pose{random.uniform(box.x_min, box.x_max), random.uniform(box.y_min, box.y_max),
                         random.uniform(-3.1, 3.1)};
        const Point2 place{pose.x, pose.y};
        const bool is_on_a_floor =
            std::ranges::any_of(world.floors, [&](const auto& floor) { return floor.contains(place); });
        if (!is_on_a_floor || sim::clearance(world, place) < 0.3) continue;
        const auto noise = is_noisy ? std::optional(sim::Noise{}) : std::nullopt;
        column.scans.push_back({.seq = column.scans.size() + 1,
                                .pose = pose,
                                .ranges = sim::sweep(world, column.sensor, pose, noise, random)});
    }
    column.half_side = half_side_of(column.scans, column.sensor.range_max);
    return column;
}

/// Adds consecutive scans from all parts of a real log, if it is on this machine.
void add_recorded(std::vector<Column>& columns, const std::string& name, const std::string& file) {
    const auto path = std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs" / file;
    if (!std::filesystem::exists(path)) return;
    auto log = robot::read_whole_log(path, {.no_return = robot::NoReturn::kDrop, .limits = {}},
                                     [](const robot::SkippedLine&) {});
    if (!log) return;
    Column column{name + "/0.05", 0.05, *log->observations.front().sensor, {}, 0.0};
    for (std::size_t n = 0; column.scans.size() < kScans && n < log->observations.size();
         n += log->observations.size() / kScans) {
        column.scans.push_back(log->observations[n].scan);
        column.scans.back().seq = column.scans.size();
    }
    column.half_side = half_side_of(column.scans, column.sensor.range_max);
    columns.push_back(std::move(column));
}

} // namespace

const std::vector<Column>& columns() {
    static const auto all = [] {
        std::vector<Column> made;
        for (const double cell_size : {0.01, 0.05, 0.1, 0.5}) made.push_back(simulated("room", "reference", cell_size));
        made.push_back(simulated("office", "lidar360", 0.05));
        made.push_back(simulated("hall", "wide", 0.05));
        add_recorded(made, "intel", "intel-corrected.log.gz");
        add_recorded(made, "fr079", "fr079-corrected.log.gz");
        for (const double cell_size : {0.01, 0.05}) made.push_back(simulated("room", "reference", cell_size, true));
        return made;
    }();
    return all;
}

} // namespace scanloom::bench
