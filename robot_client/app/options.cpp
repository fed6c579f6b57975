#include "robot_client/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/settings.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/app/ros_options.hpp"
#include "robot_client/app/simulate_options.hpp"
#include "robot_client/uplink/limits.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>

namespace scanloom::robot {
namespace {

constexpr const char* kAbout =
    "Streams a robot's scans to a Scanloom server: a log or a recording, recorded sonars, a lidar,\n"
    "a robot with foxglove_bridge, or a simulated robot.\n"
    "The same command continues after the scans that are already stored.\n"
    "Exits 0 if every scan is stored durably (an endless simulation: every scan sent until the\n"
    "interrupt), 1 if not, 2 on invalid arguments; prints a summary as one line of JSON, with the\n"
    "reason (\"error\") if it exits with 1.\n"
    "Three commands need no server: info lists what a recording contains, lidars which lidars are plugged in, and "
    "truth\n"
    "writes the ground truth map of a simulated world.";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML; those of a source in a section of its name) or in the\n"
    "environment (--cell-size as SCANLOOM_CELL_SIZE). A flag overrides the environment, which overrides the file.";

constexpr const char* kScansGroup = "Scans and poses"; // heading in the help text

/// Options as the parser sets them, before they are moved into RobotOptions.
struct Raw {
    std::string no_return;
    std::string poses; // not checked in the parser, see set_poses()
    std::optional<double> give_up_after;
    double spool_mib = 256.0;
    double memory_mib = 8.0;
    std::string when_full = "drop-oldest";
    double batch_delay = 0.0;
    double batch_kib = 64.0;
    std::string compression = "none";
};

void add_session_options(CLI::App& app, RobotOptions& options, Raw& raw) {
    // not required() in the parser: truth needs neither
    app.add_option("--session", options.session,
                   "Session for the scans; created if it does not exist. Required for streaming")
        ->check(check_name);
    app.add_option("--robot", options.robot, "Name of this robot within the session. Required for streaming")
        ->check(check_name);
    app.add_option("--cell-size", options.cell_size, "Cell size in metres, for a session that this run creates")
        ->check(check_within(kCellSizeMin, kCellSizeMax));
    app.add_option("--body-radius", options.body_radius,
                   "Body radius in metres, for viewers and as the default for planned paths. Default: that of the "
                   "simulated robot, none for recordings")
        ->check(check_above_up_to(0.0, kBodyRadiusMax));
    app.add_option("--give-up-after", raw.give_up_after,
                   "Seconds without progress until the run fails; 0 = never. Default: 120, and 0 for a live sensor")
        ->check(check_not_negative);
}

void add_waiting_options(CLI::App& app, RobotOptions& options, Raw& raw) {
    app.add_option(
        "--spool", options.spool,
        "Directory that keeps the scans of a sensor until they are stored, so that neither a long outage nor the end "
        "of this program loses any. Not for repeatable sources: logs, captures, most simulations");
    add_checked(app, "--spool-size", raw.spool_mib, "Maximum size of the spool on the disk, MiB",
                check_within(kSpoolMibMin, kSpoolMibMax));
    add_checked(app, "--memory", raw.memory_mib,
                "Maximum memory for unacknowledged scans, MiB; reading of recordings pauses at this limit",
                check_within(kMemoryMibMin, kMemoryMibMax));
    add_checked(app, "--when-full", raw.when_full,
                "Scans to drop when the spool, or without one the memory, is full. Scans that may have been sent "
                "are never dropped",
                CLI::IsMember({"drop-oldest", "drop-newest"}));
}

void add_wire_options(CLI::App& app, Raw& raw) {
    add_checked(app, "--batch-delay", raw.batch_delay,
                "Maximum time in seconds that a scan waits for others of its batch", check_within(0.0, kBatchDelayMax));
    add_checked(app, "--batch-size", raw.batch_kib, "Maximum size of a batch of scans, KiB", check_within(1.0, 1000.0));
    add_checked(app, "--compression", raw.compression, "Compression, for slow links", CLI::IsMember({"none", "zstd"}));
}

/// Converts the parts of `raw` whose form differs from `options`.
void sort_in(const Raw& raw, RobotOptions& options) {
    constexpr double kKibibyte = 1024.0;
    const auto bytes = [](double of) { return static_cast<std::uint64_t>(of); };
    const auto milliseconds = [](double seconds) {
        return std::chrono::milliseconds(static_cast<std::int64_t>(std::min(seconds, 1e9) * 1e3));
    };
    if (!raw.no_return.empty()) options.no_return = raw.no_return == "free" ? NoReturn::kFree : NoReturn::kDrop;
    if (raw.give_up_after) options.give_up_after = milliseconds(*raw.give_up_after);
    options.spool_bytes_max = bytes(raw.spool_mib * kMebibyte);
    options.memory_bytes_max = bytes(raw.memory_mib * kMebibyte);
    options.when_full = raw.when_full == "drop-newest" ? WhenFull::kDropNewest : WhenFull::kDropOldest;
    options.batch_delay = milliseconds(raw.batch_delay);
    options.batch_bytes_max = bytes(raw.batch_kib * kKibibyte);
    options.compress = raw.compression == "zstd";
}

void add_scan_options(CLI::App& app, RobotOptions& options, Raw& raw) {
    app.add_option("--max-range", options.range_max,
                   "Metres; readings of at least this length, or of the length that a line of a log states, have no "
                   "return. Default: the value of the source, for logs at most 50, and 5.11 for sonar")
        ->check(check_within(0.001, kRangeMax))
        ->group(kScansGroup);
    app.add_option("--no-return", raw.no_return,
                   "Meaning of beams without a return: free up to the range, or ignored (drop). Default: free if the "
                   "source states its sensor's range, else drop (FLASER)")
        ->check(CLI::IsMember({"free", "drop"}))
        ->group(kScansGroup);
    app.add_option(
           "--poses", raw.poses,
           "What the robot knows of its poses: map = poses in the map, which are used as they are; odometry = "
           "odometry, which drifts; none = nothing. With odometry and none the server estimates where scans "
           "were taken. The same for all scans of a robot. Default: map; for recordings of ROS and with foxglove the "
           "best that there is")
        ->type_name("TEXT:{map,odometry,none}")
        ->group(kScansGroup);
}

/// Sets what the options of all sources state of a recording of ROS.
void take_scan_options(const RobotOptions& options, RecordingOptions& recording) {
    recording.poses = options.poses;
    recording.ranges.range_max = options.range_max;
    recording.ranges.no_return = options.no_return;
}

CLI::App* add_sonar(CLI::App& app, SonarReplayOptions& options) {
    auto* sonar = app.add_subcommand("sonar", "Replay a ring of eight sonars from two text files");
    sonar
        ->add_option("MEASUREMENTS", options.measurements,
                     "Lines of: time_ms r1 .. r8, ranges in mm from right to left")
        ->configurable(false);
    sonar->add_option("POSES", options.poses, "Lines of: time_ms x y heading, in mm and tenths of a degree")
        ->configurable(false);
    add_checked(*sonar, "--aperture", options.aperture_deg, "Degrees, full width of a sonar's cone",
                check_within(1.0, 180.0));
    add_checked(*sonar, "--speed", options.speed, "1 = as recorded, 0 = as fast as the server accepts scans",
                check_not_negative);
    return sonar;
}

/// Sets options.poses to what --poses says.
/// @param word  the value of --poses
/// @param ld06  nullptr for another source. For one release, a word that is not known names the file of its poses.
/// @return an error, or an empty string
std::string set_poses(const std::string& word, LidarOptions* ld06, RobotOptions& options) {
    if (word.empty()) return {};
    if (const auto poses = find_poses(word)) {
        options.poses = *poses;
        return {};
    }
    if (ld06 == nullptr || !ld06->pose_file.empty()) {
        return fmt::format("--poses: '{}' is not map, odometry or none", word);
    }
    ld06->pose_file = word;
    ld06->is_old_name = true;
    return {};
}

} // namespace

std::variant<RobotOptions, GroundTruthOptions, InfoOptions, LidarsOptions, Leave>
parse_options(int argc, const char* const* argv) {
    RobotOptions options;
    Raw raw;
    ReplayOptions replay_options;
    SonarReplayOptions sonar_options;
    sim::SimulatedRobotOptions simulate_options;
    GroundTruthOptions truth_options;
    InfoOptions info_options;
    LidarsOptions lidars_options;
    LidarOptions ld06_options;
    LidarOptions lidar_options;
    FoxgloveOptions foxglove_options;

    CLI::App app(kAbout, "scanloom-robot");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-robot {}", kVersion));
    add_link_options(app, options, "File with the token of this robot");
    add_session_options(app, options, raw);
    add_scan_options(app, options, raw);
    add_waiting_options(app, options, raw);
    add_wire_options(app, raw);
    const CLI::App* replay = add_replay(app, replay_options)->fallthrough();
    const CLI::App* sonar = add_sonar(app, sonar_options)->fallthrough();
    const CLI::App* ld06 = add_ld06(app, ld06_options)->fallthrough();
    const CLI::App* lidar = add_lidar(app, lidar_options)->fallthrough();
    const CLI::App* foxglove = add_foxglove(app, foxglove_options)->fallthrough();
    const CLI::App* simulate = add_simulate(app, simulate_options)->fallthrough();
    const CLI::App* truth = add_ground_truth(app, truth_options)->fallthrough();
    const CLI::App* info = add_info(app, info_options)->fallthrough();
    const CLI::App* lidars = add_lidars(app, lidars_options)->fallthrough();
    app.require_subcommand(1);

    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason,
                         "name a source: replay FILE, sonar MEASUREMENTS POSES, lidar MODEL DEVICE, ld06 INPUT, "
                         "foxglove URL, or simulate; or a command: info FILE, lidars, or truth");
    }
    if (truth->parsed()) {
        if (auto mistake = mistake_in(truth_options)) return usage_error(app, *mistake);
        return truth_options;
    }
    sort_in(raw, options);
    if (const auto wrong = set_poses(raw.poses, ld06->parsed() ? &ld06_options : nullptr, options); !wrong.empty()) {
        return usage_error(app, wrong);
    }
    if (info->parsed()) {
        if (info_options.file.empty()) return usage_error(app, "info: name the FILE");
        take_scan_options(options, info_options.recording);
        info_options.scan_arguments = stated_arguments(app, kScansGroup);
        info_options.ros_arguments = stated_arguments(*info, kRecordingsGroup);
        return info_options;
    }
    if (lidars->parsed()) {
        if (const auto wrong = complaint_about(lidars_options); !wrong.empty()) return usage_error(app, wrong);
        return lidars_options;
    }
    for (const char* needed : {"--session", "--robot"}) {
        if (app.get_option(needed)->empty()) return usage_error(app, fmt::format("{} is required", needed));
    }
    if (options.cell_size && options.range_max.value_or(0.0) > kReachCellsMax * *options.cell_size) {
        return usage_error(app, fmt::format("--max-range {} spans more than {} cells of --cell-size {}, the limit of "
                                            "servers; use larger cells, or a shorter range",
                                            *options.range_max, kReachCellsMax, *options.cell_size));
    }
    const bool is_recording = !ld06->parsed() && !lidar->parsed() && !foxglove->parsed() &&
                              !(simulate->parsed() && simulate_options.drive == "explore");
    if (!options.spool.empty() && is_recording) {
        return usage_error(app, "--spool is for what cannot be had again; this source can: the same command continues "
                                "after the stored scans; leave --spool out");
    }
    if (replay->parsed()) {
        if (replay_options.file.empty()) return usage_error(app, "replay: name the FILE to replay");
        take_scan_options(options, replay_options.recording);
        replay_options.ros_arguments = stated_arguments(*replay, kRecordingsGroup);
        options.source = std::move(replay_options);
    } else if (sonar->parsed()) {
        if (sonar_options.poses.empty()) return usage_error(app, "sonar: name two files, MEASUREMENTS and POSES");
        if (options.poses == Poses::kNone) {
            return usage_error(app,
                               "sonar: with --poses none the server cannot locate a robot that has only sonars; use "
                               "--poses map or --poses odometry");
        }
        options.source = std::move(sonar_options);
    } else if (ld06->parsed() || lidar->parsed()) {
        LidarOptions& chosen = ld06->parsed() ? ld06_options : lidar_options;
        if (const auto wrong = complaint_about(chosen, options.poses.value_or(Poses::kMap)); !wrong.empty())
            return usage_error(app, wrong);
        options.source = std::move(chosen);
    } else if (foxglove->parsed()) {
        if (const auto wrong = complaint_about(foxglove_options); !wrong.empty()) return usage_error(app, wrong);
        take_scan_options(options, foxglove_options.robot);
        options.source = std::move(foxglove_options);
    } else if (simulate->parsed()) {
        if (auto mistake = mistake_in(simulate_options, options.poses.value_or(Poses::kMap)))
            return usage_error(app, *mistake);
        options.source = std::move(simulate_options);
    }
    return options;
}

} // namespace scanloom::robot
