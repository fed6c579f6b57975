#include "robot_client/app/make_source.hpp"

#include "robot_client/app/info.hpp"
#include "robot_client/ros/recorded_scans.hpp"
#include "robot_client/sources/carmen_log.hpp"
#include "robot_client/sources/ld06_capture.hpp"
#include "robot_client/sources/ld06_live.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/locating_source.hpp"
#include "robot_client/sources/pose_check.hpp"
#include "robot_client/sources/pose_feed.hpp"
#include "robot_client/sources/pose_path.hpp"
#include "robot_client/sources/sonar_log.hpp"
#include "sim/drive/behaviour.hpp"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::robot {
namespace {

using Clock = std::chrono::steady_clock;

/// Prints the first lines of a file that were skipped, and at the end the number of the others.
class SkippedLines {
public:
    SkippedLines(std::string file, Console& console) : file_(std::move(file)), console_(console) {}
    SkippedLines(const SkippedLines&) = delete;
    SkippedLines& operator=(const SkippedLines&) = delete;
    ~SkippedLines() {
        if (count_ > kShown) console_.note(fmt::format("{}: {} more lines skipped", file_, count_ - kShown));
    }

    void add(const SkippedLine& line) {
        if (++count_ > kShown) return;
        console_.note(fmt::format("{}:{}: skipped: {}", file_, line.line_number, line.reason));
    }

private:
    static constexpr std::size_t kShown = 5;

    const std::string file_;
    Console& console_;
    std::size_t count_ = 0;
};

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
    std::string first_bytes(kFormatBytes, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(first_bytes.data(), static_cast<std::streamsize>(first_bytes.size()));
    first_bytes.resize(static_cast<std::size_t>(file.gcount()));
    return format_of(first_bytes).has_value();
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

Result<PreparedSource> make_recording(const RobotOptions& options, const ReplayOptions& replay, Console& console) {
    RecordingOptions stated = replay.recording;
    stated.poses = options.poses;
    stated.ranges.range_max = options.range_max;
    stated.ranges.no_return = options.no_return;
    auto scans = RecordedScans::open(replay.file, stated, show_reading(replay.file, console));
    if (!scans) return scans.error();
    const RecordingPlan& plan = scans->plan();
    for (const auto& loss : texts_of(scans->losses())) console.note(fmt::format("{}: {}", replay.file, loss));
    for (const auto& note : plan.notes) console.note(fmt::format("{}: {}", replay.file, note));
    console.note(fmt::format("{}: {}", replay.file, poses_text(plan)));
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
    auto prepared =
        is_recording(replay.file) ? make_recording(options, replay, console) : make_log(options, replay, console);
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

// Lidars LD06 ---------------------------------------------------------------------------------------------------------

constexpr std::string_view kStandardInput = "-";

Result<Ld06ScanOptions> scan_options(const RobotOptions& options, const Ld06Options& ld06) {
    Ld06ScanOptions scan;
    scan.range_min = ld06.range_min.value_or(scan.range_min);
    scan.range_max = options.range_max.value_or(scan.range_max);
    scan.no_return = options.no_return.value_or(scan.no_return);
    if (ld06.confidence_min) scan.confidence_min = static_cast<std::uint8_t>(*ld06.confidence_min);
    scan.median_window = ld06.median_window;
    scan.mount = ld06.mount;
    scan.poses = options.poses.value_or(Poses::kMap);
    if (scan.range_min < scan.range_max) return scan;
    return Error{Errc::kInvalidField,
                 fmt::format("--min-range is {} m, but --max-range is only {} m; no reading would be valid",
                             scan.range_min, scan.range_max)};
}

Result<PoseLines> read_poses(const Ld06Options& ld06, Console& console) {
    const std::string name = ld06.pose_file == kStandardInput ? "stdin" : ld06.pose_file;
    SkippedLines skipped(name, console);
    const auto report = [&](const SkippedLine& line) { skipped.add(line); };
    return ld06.pose_file == kStandardInput ? read_pose_lines(std::cin, name, report) : read_pose_lines(name, report);
}

/// Adds a lidar that requests its position: its own poses are at the origin.
void locate(PreparedSource& prepared, const Ld06Options& ld06, std::unique_ptr<LiveSource> turns, Console& console) {
    auto locating = std::make_unique<LocatingSource>(std::move(turns), ld06.pose.value_or(Pose2{}),
                                                     [&console](const std::string& text) { console.note(text); });
    prepared.locating = locating.get();
    prepared.near = ld06.near;
    if (ld06.pose) prepared.first_place = {ld06.pose->x, ld06.pose->y};
    prepared.live = std::move(locating);
}

Result<PreparedSource> prepare_located_capture(const Ld06Options& ld06, const Ld06ScanOptions& scan, Console& console) {
    auto capture = Ld06Capture::open(ld06.input, scan, Pose2{});
    if (!capture) return capture.error();
    auto recording = std::make_unique<Ld06Capture>(std::move(*capture));
    PreparedSource prepared;
    locate(prepared, ld06, std::make_unique<ReplayedSource>(std::move(recording)), console);
    return prepared;
}

Result<PreparedSource> prepare_capture(const Ld06Options& ld06, const Ld06ScanOptions& scan, Console& console) {
    Ld06Poses poses = ld06.pose.value_or(Pose2{});
    std::optional<std::size_t> skipped;
    if (!ld06.pose_file.empty()) {
        auto lines = read_poses(ld06, console);
        if (!lines) return lines.error();
        skipped = lines->skipped;
        poses = std::move(lines->poses);
    }
    auto capture = Ld06Capture::open(ld06.input, scan, std::move(poses));
    if (!capture) return capture.error();
    PreparedSource prepared;
    prepared.skipped_lines = skipped;
    prepared.speed = ld06.speed;
    prepared.fingerprint = capture->fingerprint();
    prepared.source = std::make_unique<Ld06Capture>(std::move(*capture));
    return prepared;
}

bool is_regular_standard_input() {
    struct stat status {};
    return ::fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode);
}

/// Sets the poses of a device: a stream that is read with it, or poses known from the start.
Result<> add_live_poses(const Ld06Options& ld06, Ld06LiveOptions& live, std::optional<std::size_t>& skipped,
                        Console& console) {
    if (ld06.locate || ld06.pose_file.empty()) {
        live.poses = ld06.locate ? Pose2{} : ld06.pose.value_or(Pose2{});
    } else if (ld06.pose_file == kStandardInput && !is_regular_standard_input()) {
        live.poses = PoseTimeline();
        live.pose_descriptor = open_standard_input_again();
    } else {
        auto lines = read_poses(ld06, console);
        if (!lines) return lines.error();
        skipped = lines->skipped;
        live.poses = std::move(lines->poses);
    }
    return {};
}

Result<PreparedSource> prepare_device(const Ld06Options& ld06, const Ld06ScanOptions& scan, Ld06Endpoint endpoint,
                                      Console& console) {
    Ld06LiveOptions live;
    live.device.endpoint = std::move(endpoint);
    live.device.reopen_for = std::chrono::milliseconds(static_cast<std::int64_t>(ld06.reopen_for * 1e3));
    live.device.note = [&console](const std::string& text) { console.note(text); };
    live.scan = scan;
    PreparedSource prepared;
    if (auto added = add_live_poses(ld06, live, prepared.skipped_lines, console); !added) return added.error();
    auto turns = std::make_unique<Ld06Live>(std::move(live));
    if (ld06.locate) {
        locate(prepared, ld06, std::move(turns), console);
    } else {
        prepared.live = std::move(turns);
    }
    return prepared;
}

Result<PreparedSource> make(const RobotOptions& options, const Ld06Options& ld06, Console& console) {
    const auto scan = scan_options(options, ld06);
    if (!scan) return scan.error();
    if (ld06.is_old_name) {
        console.note(fmt::format("ld06: --poses {0} is read as the file of --pose-file until version 0.4; use "
                                 "--pose-file {0}",
                                 ld06.pose_file));
    }
    if (ld06.locate) {
        console.note("ld06: --locate is accepted until version 0.4; with --poses none the server locates the lidar in "
                     "the session's map, too, and follows it while it moves");
    }
    if (ld06.input.starts_with(kTcpScheme)) {
        const auto peer = net::parse_address(ld06.input.substr(kTcpScheme.size())); // the options were checked
        return prepare_device(ld06, *scan, peer.value(), console);
    }
    std::error_code failed;
    const auto status = std::filesystem::status(ld06.input, failed);
    if (std::filesystem::is_character_file(status)) {
        return prepare_device(ld06, *scan, SerialDevice{ld06.input}, console);
    }
    if (std::filesystem::is_regular_file(status)) {
        if (options.spool.empty()) {
            return ld06.locate ? prepare_located_capture(ld06, *scan, console) : prepare_capture(ld06, *scan, console);
        }
        return Error{
            Errc::kInvalidField,
            fmt::format("{}: a capture file is a recording and needs no --spool: {}; leave "
                        "--spool out",
                        ld06.input,
                        ld06.locate ? "it can be read again" : "the same command continues after the stored scans")};
    }
    return Error{Errc::kNotFound,
                 std::filesystem::exists(status)
                     ? fmt::format("{}: not a serial device or a file; name one", ld06.input)
                     : fmt::format("{}: no such device or file; check the path, and the cable", ld06.input)};
}

} // namespace

Result<PreparedSource> make_source(const RobotOptions& options, Console& console) {
    auto prepared = std::visit([&](const auto& source) { return make(options, source, console); }, options.source);
    if (prepared && options.poses) prepared->poses = *options.poses;
    return prepared;
}

} // namespace scanloom::robot
