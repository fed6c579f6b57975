#include "robot_client/app/make_source.hpp"

#include "robot_client/app/ld06_source.hpp"
#include "robot_client/app/simulation.hpp"
#include "robot_client/sources/carmen_log.hpp"
#include "robot_client/sources/sonar_log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <numbers>

namespace scanloom::robot {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kSkippedLinesShown = 5;

std::string order_text(const StampReport& stamps) {
    return fmt::format("stamps decrease {} times, by up to {:.3f} s: {}", stamps.steps_back, stamps.back_max,
                       stamps.file_order ? "they jitter, so the scans are sent in the order of the file"
                                         : "parts are out of order, so the scans are sent in the order of time");
}

Result<PreparedSource> make(const RobotOptions& options, const ReplayOptions& replay, Console& console) {
    std::size_t skipped = 0;
    const auto report = [&](const SkippedLine& line) {
        if (++skipped > kSkippedLinesShown) return;
        console.note(fmt::format("{}:{}: skipped: {}", replay.file, line.line_number, line.reason));
    };
    auto next_progress = Clock::now() + console.progress_period();
    const auto show = [&](const ReadProgress& progress) {
        if (Clock::now() < next_progress) return;
        next_progress = Clock::now() + console.progress_period();
        console.progress(reading_text(replay.file, progress));
    };
    auto log = CarmenLog::open(replay.file, {options.no_return, options.range_max, {}}, report, show);
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

Result<PreparedSource> make(const RobotOptions& options, const SimulateOptions& simulate, Console&) {
    return prepare_simulation(options, simulate);
}

Result<PreparedSource> make(const RobotOptions& options, const Ld06Options& ld06, Console& console) {
    return prepare_ld06(options, ld06, console);
}

} // namespace

Result<PreparedSource> make_source(const RobotOptions& options, Console& console) {
    return std::visit([&](const auto& source) { return make(options, source, console); }, options.source);
}

} // namespace scanloom::robot
