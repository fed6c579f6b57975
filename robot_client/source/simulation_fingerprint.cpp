#include "robot_client/source/simulation_fingerprint.hpp"

#include "common/hash/sha256.hpp"

#include <fmt/format.h>

#include <iterator>

namespace scanloom::robot {
namespace {

/// Doubles are written so that different ones differ.
std::string text_of(const SimulatorOptions& options, std::string_view drive, NoReturn no_return) {
    // The number is to be raised when the same options begin to give other scans: another drive, another simulator.
    std::string text = fmt::format("simulation 2\nseed {}\ndrive {}\nno-return {}\n", options.seed, drive,
                                   no_return == NoReturn::kFree ? "free" : "drop");
    const auto add = [&](std::string_view what, auto... numbers) {
        text += what;
        (fmt::format_to(std::back_inserter(text), " {}", numbers), ...);
        text += '\n';
    };
    for (const Box& box : options.world.solids) add("solid", box.x_min, box.y_min, box.x_max, box.y_max);
    for (const Box& box : options.world.floors) add("floor", box.x_min, box.y_min, box.x_max, box.y_max);
    const Sensor& laser = options.laser;
    add("laser", laser.id, laser.mount.x, laser.mount.y, laser.mount.yaw, laser.range_min, laser.range_max);
    for (std::size_t i = 0; i < beam_count(laser.angles); ++i) add("beam", beam_angle(laser.angles, i));
    if (const auto& noise = options.noise) {
        add("noise", noise->range, noise->beam_angle, noise->odometry_forward, noise->odometry_turn,
            noise->odometry_drift);
        if (noise->range_uniform > 0.0) add("uniform", noise->range_uniform);
    }
    for (const Walker& walker : options.world.walkers) {
        add("walker", walker.radius, walker.pace, walker.walked);
        for (const Point2& corner : walker.loop) add("corner", corner.x(), corner.y());
    }
    if (const auto& start = options.start) add("start", start->x, start->y, start->yaw);
    return text;
}

} // namespace

std::string fingerprint_of(const SimulatorOptions& options, std::string_view drive, NoReturn no_return) {
    Sha256 hash;
    hash.update(text_of(options, drive, no_return));
    return "simulation:" + hash.hex().substr(0, 32);
}

} // namespace scanloom::robot
