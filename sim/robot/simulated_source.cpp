#include "sim/robot/simulated_source.hpp"

#include "common/hash/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scanloom::sim {
namespace {

/// Hashes lines of a word and numbers. Doubles are written so that different ones differ.
class Lines {
public:
    template <class... Numbers>
    void add(std::string_view what, Numbers... numbers) {
        line_ = what;
        (fmt::format_to(std::back_inserter(line_), " {}", numbers), ...);
        line_ += '\n';
        hash_.update(line_);
    }

    void add_boxes(std::string_view what, const std::vector<Box>& boxes) {
        for (const Box& box : boxes) add(what, box.x_min, box.y_min, box.x_max, box.y_max);
    }

    void add_sensor(std::string_view what, const Sensor& sensor) {
        add(what, sensor.id, sensor.mount.x, sensor.mount.y, sensor.mount.yaw, sensor.range_min, sensor.range_max);
        if (sensor.aperture > 0.0) add("aperture", sensor.aperture);
        for (std::size_t i = 0; i < beam_count(sensor.angles); ++i) add("beam", beam_angle(sensor.angles, i));
    }

    [[nodiscard]] std::string hex() { return hash_.hex(); }

private:
    Sha256 hash_;
    std::string line_;
};

void add_world(Lines& lines, const World& world) {
    lines.add_boxes("solid", world.solids);
    lines.add_boxes("floor", world.floors);
    lines.add_boxes("unknown", world.unknown);
    if (world.starts != world.floors) lines.add_boxes("start-box", world.starts);
    if (world.start_clearance != kStartClearance) lines.add("start-clearance", world.start_clearance);
}

} // namespace

// A line that older versions did not have is added only if it has an effect, so equal scans keep their fingerprint.
std::string fingerprint_of(const SimulatorOptions& options, std::string_view drive, robot::NoReturn no_return) {
    Lines lines;
    // Increase the number when the same options give different scans: another drive, another simulator.
    lines.add("simulation", 2);
    lines.add("seed", options.seed);
    lines.add("drive", drive);
    lines.add("no-return", no_return == robot::NoReturn::kFree ? "free" : "drop");
    add_world(lines, options.world);
    if (options.laser) lines.add_sensor("laser", *options.laser);
    if (options.sonar) lines.add_sensor("sonar", *options.sonar);
    if (options.pose == PoseSent::kOdometry) lines.add("pose", "odometry");
    if (options.is_carried) lines.add("carried", kWalkMax.forward, kWalkMax.turn);
    if (options.poses != Poses::kMap) lines.add("poses", name_of(options.poses));
    if (const auto& noise = options.noise) {
        lines.add("noise", noise->range, noise->beam_angle, noise->odometry_forward, noise->odometry_turn,
                  noise->odometry_drift);
        if (noise->range_uniform > 0.0) lines.add("uniform", noise->range_uniform);
    }
    for (const Walker& walker : options.world.walkers) {
        lines.add("walker", walker.radius, walker.pace, walker.walked);
        for (const Point2& corner : walker.loop) lines.add("corner", corner.x, corner.y);
    }
    if (const auto& start = options.start) lines.add("start", start->x, start->y, start->yaw);
    return "simulation:" + lines.hex().substr(0, 32);
}

std::uint64_t scans_within(double duration, std::size_t sensors) {
    const double moments =
        std::ceil(duration / kScanPeriod - 1e-6); // 0.3 s are three periods of 0.1 s despite rounding
    const double scans = moments * static_cast<double>(sensors);
    return scans < 1e15 ? static_cast<std::uint64_t>(scans) : std::numeric_limits<std::uint64_t>::max();
}

robot::Observation observed(Simulator& simulator, robot::NoReturn no_return) {
    robot::Observation observation{nullptr, simulator.next_scan()};
    observation.sensor = simulator.sensor_of(observation.scan);
    if (no_return == robot::NoReturn::kDrop) {
        auto& ranges = observation.scan.ranges;
        std::replace(ranges.begin(), ranges.end(), kNoReturn, kInvalidRange);
    }
    return observation;
}

SimulatedSource::SimulatedSource(Simulator simulator, SimulationLimits limits, robot::NoReturn no_return)
    : simulator_(std::move(simulator)), limits_(limits), no_return_(no_return) {
    limits_.scans = std::min(limits_.scans, scans_within(limits_.duration, simulator_.sensors().size()));
}

Result<std::optional<robot::Observation>> SimulatedSource::next() {
    if (scans_ == limits_.scans || is_done()) return std::optional<robot::Observation>{};
    ++scans_;
    return std::optional(observed(simulator_, no_return_));
}

std::optional<std::uint64_t> SimulatedSource::scan_count() const {
    if (is_done() || scans_ == limits_.scans) return scans_;
    if (simulator_.behaviour().has_an_end()) return std::nullopt;
    if (limits_.scans == std::numeric_limits<std::uint64_t>::max()) return std::nullopt;
    return limits_.scans;
}

} // namespace scanloom::sim
