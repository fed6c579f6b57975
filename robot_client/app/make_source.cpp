#include "robot_client/app/make_source.hpp"

#include "robot_client/app/ld06_source.hpp"
#include "robot_client/drive/wall_follower.hpp"
#include "robot_client/sim/simulator.hpp"
#include "robot_client/sim/unicycle.hpp"
#include "robot_client/source/carmen_log.hpp"
#include "robot_client/source/simulated_source.hpp"
#include "robot_client/source/simulation_fingerprint.hpp"
#include "robot_client/source/sonar_log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <numbers>

namespace scanloom::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kSkippedLinesShown = 5;

std::string order_text(const StampReport& stamps) {
    return fmt::format("stamps go back {} times, by up to {:.3f} s: {}", stamps.steps_back, stamps.back_max,
                       stamps.file_order ? "they jitter, and the scans are sent in the order of the file"
                                         : "parts are out of their place, and the scans are sent in the order of time");
}

Result<PreparedSource> make(const RobotOptions& options, const ReplayOptions& replay, Console& console) {
    std::size_t skipped = 0;
    const auto tell = [&](const SkippedLine& line) {
        if (++skipped > kSkippedLinesShown) return;
        console.note(fmt::format("{}:{}: skipped: {}", replay.file, line.line_number, line.reason));
    };
    auto next_progress = Clock::now() + console.progress_period();
    const auto show = [&](const ReadProgress& progress) {
        if (Clock::now() < next_progress) return;
        next_progress = Clock::now() + console.progress_period();
        console.progress(reading_text(replay.file, progress));
    };
    auto log = CarmenLog::open(replay.file, {options.no_return, options.range_max, {}}, tell, show);
    if (skipped > kSkippedLinesShown) {
        console.note(fmt::format("{}: {} more lines skipped", replay.file, skipped - kSkippedLinesShown));
    }
    if (!log) return log.error();
    const StampReport& stamps = log->stamps();
    if (stamps.steps_back > 0) console.note(fmt::format("{}: {}", replay.file, order_text(stamps)));
    PreparedSource prepared{
        nullptr, log->skipped_lines(), replay.speed, log->fingerprint(), stamps.file_order ? "file" : "time", {}};
    prepared.source = std::make_unique<CarmenLog>(std::move(*log));
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const SonarReplayOptions& sonar, Console&) {
    SonarOptions ring;
    ring.no_return = options.no_return.value_or(ring.no_return);
    ring.range_max = options.range_max.value_or(ring.range_max);
    ring.aperture = sonar.aperture_deg * std::numbers::pi / 180.0;
    auto log = SonarLog::open(sonar.measurements, sonar.poses, ring);
    if (!log) return log.error();
    PreparedSource prepared{nullptr, 0, sonar.speed, log->fingerprint(), "file", {}};
    prepared.source = std::make_unique<SonarLog>(std::move(*log));
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const SimulateOptions& simulate, Console&) {
    auto world = find_world(simulate.world);
    if (!world) return world.error();
    auto laser = find_laser(simulate.laser);
    if (!laser) return laser.error();
    if (options.range_max) laser->range_max = *options.range_max;
    if (laser->range_max <= laser->range_min) {
        return Error{Errc::kInvalidField, fmt::format("--max-range is {} m, but the laser {} begins to see at {} m",
                                                      laser->range_max, simulate.laser, laser->range_min)};
    }
    SimulatorOptions simulator{std::move(*world), std::move(*laser), std::nullopt, simulate.seed};
    if (simulate.noise == "gaussian") simulator.noise = Noise{};
    if (simulate.noise == "uniform") {
        simulator.noise = Noise{.range = 0.0, .range_uniform = simulate.noise_width, .beam_angle = 0.0};
    }
    SimulationLimits limits;
    if (simulate.duration) limits.duration = *simulate.duration;
    if (simulate.scans) limits.scans = *simulate.scans;
    const NoReturn no_return = options.no_return.value_or(NoReturn::kFree);
    PreparedSource prepared{nullptr, 0,          simulate.speed, fingerprint_of(simulator, simulate.drive, no_return),
                            "time",  kBodyRadius};
    prepared.source = std::make_unique<SimulatedSource>(
        Simulator(std::move(simulator), std::make_unique<WallFollower>()), limits, no_return);
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const Ld06Options& ld06, Console& console) {
    return prepare_ld06(options, ld06, console);
}

} // namespace

Result<PreparedSource> make_source(const RobotOptions& options, Console& console) {
    return std::visit([&](const auto& source) { return make(options, source, console); }, options.source);
}

} // namespace scanloom::robot
