#include "robot_client/app/options.hpp"

#include "common/app/environment_first.hpp"
#include "common/app/option_checks.hpp"
#include "common/app/parse_failure.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/app/host_port.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>

namespace scanloom::robot {
namespace {

constexpr const char* kAbout =
    "Streams a robot's scans to a Scanloom server: a recorded log, recorded sonars, a lidar,\n"
    "or a simulated robot.\n"
    "The same command again continues behind the scans that are stored already.\n"
    "Exits 0 when every scan is stored durably (a simulation without an end: every scan sent\n"
    "until it was interrupted), 1 when not, 2 when it was called wrongly; prints a summary as one line\n"
    "of JSON, with the reason (\"error\") where it exits 1.";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML; those of a source in a section of its name) or in the\n"
    "environment (--cell-size as SCANLOOM_CELL_SIZE). A flag beats the environment, which beats the file.";

/// As the parser fills it, before it is sorted into RobotOptions.
struct Raw {
    std::string server = "127.0.0.1:7447";
    std::string no_return;
    double give_up_after = 120.0;
};

std::string check_name(const std::string& name) {
    if (is_valid_name(name)) return {};
    return fmt::format("'{}' is not a name; use 1 to {} characters of A-Z a-z 0-9 _ -", name, kNameBytesMax);
}

void add_link_options(CLI::App& app, RobotOptions& options, Raw& raw) {
    app.add_option("--server", raw.server, "Robot port of the server, HOST:PORT")->capture_default_str();
    app.add_option("--session", options.session, "Session to add to; made if it does not exist")
        ->required()
        ->check(check_name);
    app.add_option("--robot", options.robot, "Name of this robot within the session")->required()->check(check_name);
    app.add_option("--token-file", options.token_file, "File that holds the token of this robot")
        ->check(CLI::ExistingFile);
    app.add_option("--cell-size", options.cell_size, "Metres a cell, for a session made here")
        ->check(check_within(0.01, 1.0));
    app.add_option("--body-radius", options.body_radius,
                   "Metres, of the robot's body, for viewers and as the default of planned ways. Default: that of the "
                   "simulated robot, for recordings none")
        ->check(check_above_up_to(0.0, kBodyRadiusMax));
    app.add_option("--give-up-after", raw.give_up_after, "Seconds without progress until it fails; 0 = never")
        ->check(check_not_negative)
        ->capture_default_str();
}

void add_scan_options(CLI::App& app, RobotOptions& options, Raw& raw) {
    app.add_option("--max-range", options.range_max,
                   "Metres; readings of this length or more are no-return, and those of the length that a line of a "
                   "log states. "
                   "Default: what the source states, for logs 50 at most, and 5.11 for sonar")
        ->check(check_within(0.001, kRangeMax));
    app.add_option("--no-return", raw.no_return,
                   "What beams without a return mean: free up to the range, or nothing (drop). Default: free where the "
                   "source states its sensor's range, drop where it does not (FLASER)")
        ->check(CLI::IsMember({"free", "drop"}));
}

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
    auto* replay = app.add_subcommand("replay", "Replay a CARMEN log");
    // not required() by the parser: an environment meant for both sources would then ask for it everywhere
    replay->add_option("FILE", options.file, "CARMEN log, plain, gzip or bzip2")->configurable(false);
    replay
        ->add_option("--speed", options.speed,
                     "1 = as recorded, 0 = as fast as the server takes it. A pause of more than 10 minutes in the log "
                     "counts as 10")
        ->check(check_not_negative)
        ->capture_default_str();
    return replay;
}

CLI::App* add_sonar(CLI::App& app, SonarReplayOptions& options) {
    auto* sonar = app.add_subcommand("sonar", "Replay a ring of eight sonars from two text files");
    sonar
        ->add_option("MEASUREMENTS", options.measurements,
                     "Lines of: time_ms r1 .. r8, ranges in mm from right to left")
        ->configurable(false);
    sonar->add_option("POSES", options.poses, "Lines of: time_ms x y heading, in mm and tenths of a degree")
        ->configurable(false);
    sonar->add_option("--aperture", options.aperture_deg, "Degrees, full width of a sonar's cone")
        ->check(check_within(1.0, 180.0))
        ->capture_default_str();
    sonar->add_option("--speed", options.speed, "1 = as recorded, 0 = as fast as the server takes it")
        ->check(check_not_negative)
        ->capture_default_str();
    return sonar;
}

CLI::App* add_simulate(CLI::App& app, SimulateOptions& options) {
    auto* simulate = app.add_subcommand("simulate", "Simulate a robot that drives through a world");
    simulate->add_option("--world", options.world, "Where it drives")
        ->check(CLI::IsMember({"room", "room_walker", "office"}))
        ->capture_default_str();
    simulate->add_option("--drive", options.drive, "How it drives")
        ->check(CLI::IsMember({"wall_follower"}))
        ->capture_default_str();
    simulate->add_option("--laser", options.laser, "What it sees with")
        ->check(CLI::IsMember({"reference", "lidar360", "wide"}))
        ->capture_default_str();
    simulate->add_option("--noise", options.noise, "What its measurements suffer from")
        ->check(CLI::IsMember({"none", "gaussian", "uniform"}))
        ->capture_default_str();
    simulate
        ->add_option("--noise-width", options.noise_width,
                     "Metres; uniform noise makes each reading too long by 0 up to this")
        ->check(check_positive)
        ->capture_default_str();
    simulate->add_option("--seed", options.seed, "The same seed gives the same scans")
        ->check(check_whole_number_from(0))
        ->capture_default_str();
    simulate
        ->add_option("--duration", options.duration,
                     "Seconds to simulate, earlier runs included; default: until interrupted")
        ->check(check_positive);
    simulate->add_option("--scans", options.scans, "Scans to take, earlier runs included; default: until interrupted")
        ->check(check_whole_number_from(1));
    simulate->add_option("--speed", options.speed, "1 = real time, 0 = as fast as the server takes it")
        ->check(check_not_negative)
        ->capture_default_str();
    return simulate;
}

} // namespace

std::variant<RobotOptions, Leave> parse_options(int argc, const char* const* argv) {
    RobotOptions options;
    Raw raw;
    ReplayOptions replay_options;
    SonarReplayOptions sonar_options;
    SimulateOptions simulate_options;
    Ld06Options ld06_options;

    CLI::App app(kAbout, "scanloom-robot");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-robot {}", kVersion));
    add_link_options(app, options, raw);
    add_scan_options(app, options, raw);
    const CLI::App* replay = add_replay(app, replay_options)->fallthrough();
    const CLI::App* sonar = add_sonar(app, sonar_options)->fallthrough();
    const CLI::App* ld06 = add_ld06(app, ld06_options)->fallthrough();
    add_simulate(app, simulate_options)->fallthrough();
    app.require_subcommand(1);

    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason,
                         "say what to stream: replay FILE, sonar MEASUREMENTS POSES, ld06 INPUT, or simulate");
    }
    const auto server = split_host_port(raw.server);
    if (!server) return usage_error(app, fmt::format("--server: '{}' is not HOST:PORT", raw.server));
    options.host = server->host;
    options.port = server->port;
    if (options.cell_size && options.range_max.value_or(0.0) > kReachCellsMax * *options.cell_size) {
        return usage_error(app,
                           fmt::format("--max-range {} spans more than {} cells of --cell-size {}, the most that a "
                                       "server takes; use larger cells, or a shorter range",
                                       *options.range_max, kReachCellsMax, *options.cell_size));
    }
    if (!raw.no_return.empty()) options.no_return = raw.no_return == "free" ? NoReturn::kFree : NoReturn::kDrop;
    options.give_up_after =
        std::chrono::milliseconds(static_cast<std::int64_t>(std::min(raw.give_up_after, 1e9) * 1e3));
    if (replay->parsed()) {
        if (replay_options.file.empty()) return usage_error(app, "replay: name the FILE to replay");
        options.source = std::move(replay_options);
    } else if (sonar->parsed()) {
        if (sonar_options.poses.empty()) return usage_error(app, "sonar: name two files, MEASUREMENTS and POSES");
        options.source = std::move(sonar_options);
    } else if (ld06->parsed()) {
        if (const auto wrong = complaint_about(ld06_options); !wrong.empty()) return usage_error(app, wrong);
        options.source = std::move(ld06_options);
    } else {
        options.source = std::move(simulate_options);
    }
    return options;
}

} // namespace scanloom::robot
