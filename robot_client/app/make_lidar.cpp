#include "robot_client/app/make_lidar.hpp"

#include "robot_client/app/skipped_lines.hpp"
#include "robot_client/lidars/ld06_capture.hpp"
#include "robot_client/lidars/lidar_live.hpp"
#include "robot_client/lidars/lidar_models.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/locating_source.hpp"
#include "robot_client/sources/pose_feed.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::string_view kStandardInput = "-";

Result<LidarScanOptions> readings_of(const LidarModel& model, const RobotOptions& options, const LidarOptions& lidar) {
    return scan_options(model, {.range_min = lidar.range_min,
                                .range_max = options.range_max,
                                .no_return = options.no_return,
                                .confidence_min = lidar.confidence_min,
                                .median_window = lidar.median_window,
                                .mount = lidar.mount,
                                .poses = options.poses.value_or(Poses::kMap)});
}

Result<PoseLines> read_poses(const LidarOptions& lidar, Console& console) {
    const std::string name = lidar.pose_file == kStandardInput ? "stdin" : lidar.pose_file;
    SkippedLines skipped(name, console);
    const auto report = [&](const SkippedLine& line) { skipped.add(line); };
    return lidar.pose_file == kStandardInput ? read_pose_lines(std::cin, name, report) : read_pose_lines(name, report);
}

/// Adds a lidar that requests its position: its own poses are at the origin.
void locate(PreparedSource& prepared, const LidarOptions& lidar, std::unique_ptr<LiveSource> turns, Console& console) {
    auto locating = std::make_unique<LocatingSource>(std::move(turns), lidar.pose.value_or(Pose2{}),
                                                     [&console](const std::string& text) { console.note(text); });
    prepared.locating = locating.get();
    prepared.near = lidar.near;
    if (lidar.pose) prepared.first_place = {lidar.pose->x, lidar.pose->y};
    prepared.live = std::move(locating);
}

Result<PreparedSource> prepare_located_capture(const LidarOptions& lidar, const LidarScanOptions& scan,
                                               Console& console) {
    auto capture = Ld06Capture::open(lidar.input, scan, Pose2{});
    if (!capture) return capture.error();
    auto recording = std::make_unique<Ld06Capture>(std::move(*capture));
    PreparedSource prepared;
    locate(prepared, lidar, std::make_unique<ReplayedSource>(std::move(recording)), console);
    return prepared;
}

Result<PreparedSource> prepare_capture(const LidarOptions& lidar, const LidarScanOptions& scan, Console& console) {
    LidarPoses poses = lidar.pose.value_or(Pose2{});
    std::optional<std::size_t> skipped;
    if (!lidar.pose_file.empty()) {
        auto lines = read_poses(lidar, console);
        if (!lines) return lines.error();
        skipped = lines->skipped;
        poses = std::move(lines->poses);
    }
    auto capture = Ld06Capture::open(lidar.input, scan, std::move(poses));
    if (!capture) return capture.error();
    PreparedSource prepared;
    prepared.skipped_lines = skipped;
    prepared.speed = lidar.speed;
    prepared.fingerprint = capture->fingerprint();
    prepared.source = std::make_unique<Ld06Capture>(std::move(*capture));
    return prepared;
}

Result<PreparedSource> prepare_file(const RobotOptions& options, const LidarOptions& lidar,
                                    const LidarScanOptions& scan, Console& console) {
    if (!lidar.is_ld06_command) {
        return Error{Errc::kInvalidField,
                     fmt::format("{}: a file, not a device; files with the bytes of an LD06 are read by scanloom-robot "
                                 "ld06",
                                 lidar.input)};
    }
    if (options.spool.empty()) {
        return lidar.locate ? prepare_located_capture(lidar, scan, console) : prepare_capture(lidar, scan, console);
    }
    return Error{
        Errc::kInvalidField,
        fmt::format("{}: a capture file is a recording and needs no --spool: {}; leave --spool out", lidar.input,
                    lidar.locate ? "it can be read again" : "the same command continues after the stored scans")};
}

bool is_regular_standard_input() {
    struct stat status {};
    return ::fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode);
}

/// Sets the poses of a device: a stream that is read with it, or poses known from the start.
Result<> add_live_poses(const LidarOptions& lidar, LidarLiveOptions& live, std::optional<std::size_t>& skipped,
                        Console& console) {
    if (lidar.locate || lidar.pose_file.empty()) {
        live.poses = lidar.locate ? Pose2{} : lidar.pose.value_or(Pose2{});
    } else if (lidar.pose_file == kStandardInput && !is_regular_standard_input()) {
        live.poses = PoseTimeline();
        live.pose_descriptor = open_standard_input_again();
    } else {
        auto lines = read_poses(lidar, console);
        if (!lines) return lines.error();
        skipped = lines->skipped;
        live.poses = std::move(lines->poses);
    }
    return {};
}

Result<PreparedSource> prepare_device(const LidarModel& model, const LidarOptions& lidar, const LidarScanOptions& scan,
                                      LidarEndpoint endpoint, Console& console) {
    LidarLiveOptions live;
    live.device.endpoint = std::move(endpoint);
    live.device.reopen_for = std::chrono::milliseconds(static_cast<std::int64_t>(lidar.reopen_for * 1e3));
    live.device.note = [&console](const std::string& text) { console.note(text); };
    live.device.serial = model.serial;
    live.device.serial.baud = lidar.baud.value_or(model.serial.baud);
    live.driver = make_lidar_driver(model, scan);
    live.kind = scan.poses;
    PreparedSource prepared;
    if (auto added = add_live_poses(lidar, live, prepared.skipped_lines, console); !added) return added.error();
    auto turns = std::make_unique<LidarLive>(std::move(live));
    if (lidar.locate) {
        locate(prepared, lidar, std::move(turns), console);
    } else {
        prepared.live = std::move(turns);
    }
    return prepared;
}

} // namespace

Result<PreparedSource> make_lidar(const RobotOptions& options, const LidarOptions& lidar, Console& console) {
    const LidarModel& model = *find_lidar_model(lidar.model); // the options were checked
    const auto scan = readings_of(model, options, lidar);
    if (!scan) return scan.error();
    if (lidar.is_old_name) {
        console.note(fmt::format("ld06: --poses {0} is read as the file of --pose-file until version 0.4; use "
                                 "--pose-file {0}",
                                 lidar.pose_file));
    }
    if (lidar.locate) {
        console.note("ld06: --locate is accepted until version 0.4; with --poses none the server locates the lidar in "
                     "the session's map, too, and follows it while it moves");
    }
    if (lidar.input.starts_with(kTcpScheme)) {
        const auto peer = net::parse_address(lidar.input.substr(kTcpScheme.size())); // the options were checked
        return prepare_device(model, lidar, *scan, peer.value(), console);
    }
    std::error_code failed;
    const auto status = std::filesystem::status(lidar.input, failed);
    if (std::filesystem::is_character_file(status)) {
        return prepare_device(model, lidar, *scan, SerialDevice{lidar.input}, console);
    }
    if (std::filesystem::is_regular_file(status)) return prepare_file(options, lidar, *scan, console);
    return Error{Errc::kNotFound,
                 std::filesystem::exists(status)
                     ? fmt::format("{}: not a serial device or a file; name one", lidar.input)
                     : fmt::format("{}: no such device or file; check the path, and the cable", lidar.input)};
}

} // namespace scanloom::robot
