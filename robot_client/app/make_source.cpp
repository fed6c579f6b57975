#include "robot_client/app/make_source.hpp"

#include "robot_client/app/info.hpp"
#include "robot_client/app/make_foxglove.hpp"
#include "robot_client/app/make_lidar.hpp"
#include "robot_client/app/skipped_lines.hpp"
#include "robot_client/ros/frame_choice.hpp"
#include "robot_client/ros/recorded_scans.hpp"
#include "robot_client/sources/carmen_log.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/pose_check.hpp"
#include "robot_client/sources/sonar_log.hpp"
#include "sim/drive/behaviour.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace scanloom::robot {
namespace {

using Clock = std::chrono::steady_clock;

std::string order_text(const StampReport& stamps) {
    const std::string_view order =
        stamps.is_clock_set_back
            ? "the clock was set back or a stamp is wrong, so the scans are sent in the order of the file"
        : stamps.file_order ? "they jitter, so the scans are sent in the order of the file"
                            : "parts are out of order, so the scans are sent in the order of time";
    return fmt::format("stamps decrease {} times, by up to {:.3f} s: {}", stamps.steps_back, stamps.back_max, order);
}

/// Says if stamps go back, and in which order scans are sent.
void note_order(const StampReport& stamps, const std::string& file, PreparedSource& prepared, Console& console) {
    if (stamps.steps_back > 0) console.note(fmt::format("{}: {}", file, order_text(stamps)));
    prepared.order = stamps.file_order ? "file" : "time";
}

/// Returns whether a file is a recording of ROS, readable or not.
bool is_recording(const std::string& path) {
    if (std::error_code unknown; std::filesystem::is_directory(path, unknown)) return true;
    std::string first_bytes(kFormatBytes, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(first_bytes.data(), static_cast<std::streamsize>(first_bytes.size()));
    first_bytes.resize(static_cast<std::size_t>(file.gcount()));
    return format_of(first_bytes).has_value();
}

/// Returns whether a file is a recording of ROS that is compressed as a whole, as no recorder does.
bool is_compressed_recording(const std::string& path) {
    auto reader = LineReader::open(path);
    const auto line = reader ? reader->next() : Result<std::optional<std::string_view>>(std::nullopt);
    return line && *line && format_of(std::string(**line) + '\n').has_value();
}

/// Shows how far a file has been read, from time to time.
OnRead show_reading(const std::string& file, Console& console) {
    return [file, &console, next = Clock::now() + console.progress_period()](const ReadProgress& progress) mutable {
        if (Clock::now() < next) return;
        next = Clock::now() + console.progress_period();
        console.progress(reading_text(file, progress));
    };
}

Result<PreparedSource> make_log(const RobotOptions& options, const ReplayOptions& replay, Console& console) {
    if (is_compressed_recording(replay.file)) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: a recording of ROS that is compressed as a whole; decompress it with `gunzip` or "
                                 "`bunzip2`, and name the decompressed file",
                                 replay.file)};
    }
    if (!replay.ros_arguments.empty()) {
        console.note(fmt::format("{}: not a recording of ROS; without effect:{}", replay.file, replay.ros_arguments));
    }
    std::optional<SkippedLines> skipped(std::in_place, replay.file, console);
    const auto report = [&](const SkippedLine& line) { skipped->add(line); };
    auto log =
        CarmenLog::open(replay.file, {options.no_return, options.range_max, {}, options.poses.value_or(Poses::kMap)},
                        report, show_reading(replay.file, console));
    skipped.reset();
    if (!log) return log.error();
    PreparedSource prepared;
    prepared.skipped_lines = log->skipped_lines();
    prepared.speed = replay.speed;
    prepared.fingerprint = log->fingerprint();
    note_order(log->stamps(), replay.file, prepared, console);
    prepared.source = std::make_unique<CarmenLog>(std::move(*log));
    return prepared;
}

Result<PreparedSource> make_recording(const ReplayOptions& replay, Console& console) {
    auto scans = RecordedScans::open(replay.file, replay.recording, show_reading(replay.file, console));
    if (!scans) return scans.error();
    const RecordingPlan& plan = scans->plan();
    for (const auto& loss : texts_of(scans->losses())) console.note(fmt::format("{}: {}", replay.file, loss));
    for (const auto& note : plan.notes) console.note(fmt::format("{}: {}", replay.file, note));
    console.note(
        fmt::format("{}: {}", replay.file, poses_text(plan.poses, plan.base_frame, plan.fixed_frame, plan.odom_topic)));
    PreparedSource prepared;
    prepared.left_out = LeftOut{plan.skipped, scans->losses().count};
    prepared.poses = plan.poses;
    prepared.speed = replay.speed;
    prepared.fingerprint = plan.fingerprint;
    note_order(plan.stamps, replay.file, prepared, console);
    prepared.source = std::make_unique<RecordedScans>(std::move(*scans));
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const ReplayOptions& replay, Console& console) {
    auto prepared = is_recording(replay.file) ? make_recording(replay, console) : make_log(options, replay, console);
    if (prepared) prepared->source = std::make_unique<CheckedPoses>(std::move(prepared->source));
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const SonarReplayOptions& sonar, Console&) {
    SonarOptions ring;
    ring.no_return = options.no_return.value_or(ring.no_return);
    ring.range_max = options.range_max.value_or(ring.range_max);
    ring.poses = options.poses.value_or(Poses::kMap);
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

Result<PreparedSource> make(const RobotOptions& options, sim::SimulatedRobotOptions simulate, Console&) {
    simulate.range_max = options.range_max;
    simulate.poses = options.poses.value_or(Poses::kMap);
    simulate.no_return = options.no_return.value_or(simulate.no_return);
    auto robot = sim::make_simulated_robot(simulate);
    if (!robot) return robot.error();
    PreparedSource prepared;
    prepared.speed = simulate.speed;
    prepared.body_radius = sim::kBodyRadius;
    prepared.fingerprint = std::move(robot->fingerprint);
    prepared.source = std::move(robot->source);
    prepared.exploring = robot->exploring.get();
    prepared.live = std::move(robot->exploring);
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const LidarOptions& lidar, Console& console) {
    return make_lidar(options, lidar, console);
}

Result<PreparedSource> make(const RobotOptions& options, const FoxgloveOptions& foxglove, Console& console) {
    auto source = make_foxglove(options, foxglove, console);
    if (!source) return source.error();
    PreparedSource prepared;
    prepared.foxglove = source->get();
    prepared.live = std::move(*source);
    return prepared;
}

} // namespace

Result<PreparedSource> make_source(const RobotOptions& options, Console& console) {
    auto prepared = std::visit([&](const auto& source) { return make(options, source, console); }, options.source);
    if (prepared && options.poses) prepared->poses = *options.poses;
    return prepared;
}

} // namespace scanloom::robot
