#include "robot_client/app/make_source.hpp"

#include "robot_client/app/ld06_source.hpp"
#include "robot_client/drive/wall_follower.hpp"
#include "robot_client/sim/simulator.hpp"
#include "robot_client/sim/unicycle.hpp"
#include "robot_client/source/carmen_log.hpp"
#include "robot_client/source/simulated_source.hpp"
#include "robot_client/source/simulation_fingerprint.hpp"
#include "robot_client/source/sonar_log.hpp"
#include "robot_client/source/world_file.hpp"

#include <fmt/format.h>

#include <algorithm>
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
    PreparedSource prepared;
    prepared.skipped_lines = log->skipped_lines();
    prepared.speed = replay.speed;
    prepared.fingerprint = log->fingerprint();
    prepared.order = stamps.file_order ? "file" : "time";
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
    PreparedSource prepared;
    prepared.speed = sonar.speed;
    prepared.fingerprint = log->fingerprint();
    prepared.order = "file";
    prepared.source = std::make_unique<SonarLog>(std::move(*log));
    return prepared;
}

Result<> check_range(const Sensor& sensor) {
    if (sensor.range_max > sensor.range_min) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("--max-range is {} m, but the {} {} begins to see at {} m", sensor.range_max,
                             sensor.kind == SensorKind::kLaser ? "laser" : "sonar", sensor.name, sensor.range_min)};
}

/// Errors  unknown names, and a range that leaves a sensor nothing to see.
Result<> choose_sensors(const RobotOptions& options, const SimulateOptions& simulate, SimulatorOptions& simulator) {
    if (simulate.laser != "none") {
        auto laser = find_laser(simulate.laser);
        if (!laser) return laser.error();
        if (options.range_max) laser->range_max = *options.range_max;
        if (auto ok = check_range(*laser); !ok) return ok.error();
        simulator.laser = std::move(*laser);
    }
    if (simulate.sonar != "none") {
        auto sonar = find_sonar(simulate.sonar);
        if (!sonar) return sonar.error();
        sonar->range_max = std::min(sonar->range_max, options.range_max.value_or(sonar->range_max));
        if (auto ok = check_range(*sonar); !ok) return ok.error();
        simulator.sonar = std::move(*sonar);
    }
    return {};
}

std::optional<Noise> noise_of(const SimulateOptions& simulate) {
    constexpr Noise kOfOdometryOnly{.range = 0.0, .beam_angle = 0.0};
    const double odometry = simulate.odometry_noise.value_or(simulate.noise == "none" ? 0.0 : 1.0);
    if (simulate.noise == "gaussian") return with_odometry({}, odometry);
    if (simulate.noise == "uniform") {
        Noise noise = kOfOdometryOnly;
        noise.range_uniform = simulate.noise_width;
        return with_odometry(noise, odometry);
    }
    if (odometry > 0.0) return with_odometry(kOfOdometryOnly, odometry);
    return std::nullopt;
}

Result<PreparedSource> make(const RobotOptions& options, const SimulateOptions& simulate, Console&) {
    auto world = load_world(simulate.world);
    if (!world) return world.error();
    SimulatorOptions simulator;
    simulator.world = std::move(*world);
    simulator.noise = noise_of(simulate);
    simulator.seed = simulate.seed;
    simulator.pose = simulate.pose == "odometry" ? PoseSent::kOdometry : PoseSent::kTrue;
    if (auto chosen = choose_sensors(options, simulate, simulator); !chosen) return chosen.error();
    SimulationLimits limits;
    if (simulate.duration) limits.duration = *simulate.duration;
    if (simulate.scans) limits.scans = *simulate.scans;
    const NoReturn no_return = options.no_return.value_or(NoReturn::kFree);
    PreparedSource prepared;
    prepared.speed = simulate.speed;
    prepared.fingerprint = fingerprint_of(simulator, simulate.drive, no_return);
    prepared.body_radius = kBodyRadius;
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
