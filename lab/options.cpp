#include "lab/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/settings.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace scanloom::lab {
namespace {

constexpr const char* kAbout = "Measures the quality and speed of maps and landmarks in simulated worlds with exact "
                               "ground truth, and of estimated\n"
                               "trajectories on recorded logs. Simulates clusters of servers.\n"
                               "Exits 0 when done, 1 on failure, 2 on invalid arguments.";
constexpr const char* kOutHelp = "Directory for report.md, report.html, times.md, times.html and pictures/; created if "
                                 "it does not exist; existing files are overwritten";
constexpr const char* kSeedHelp = "Seed of the noise; the same seed gives the same report, except for times";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML, in a section of its command) or in the environment\n"
    "(--seed as SCANLOOM_SEED). A flag overrides the environment, which overrides the file.";

CLI::App* add_experiment(CLI::App& app, ExperimentOptions& options) {
    auto* experiment = app.add_subcommand(
        "experiment", "The reference experiments: scenes, cell sizes, ray models, noise and starts, as a report");
    experiment->add_option("--out", options.out, kOutHelp);
    experiment->add_option("--seed", options.seed, kSeedHelp)->check(check_whole_number_from(0))->capture_default_str();
    experiment
        ->add_option("--scans", options.scans, "Scans of each run, 10 to 100000; default: 1500, once around the room")
        ->check(check_within(10, 100'000))
        ->check(check_whole_number_from(1));
    experiment->add_flag("--quick", options.quick,
                         "Coarse cells, two kinds of noise and one start: seconds, not minutes");
    return experiment;
}

CLI::App* add_landmarks(CLI::App& app, LandmarkOptions& options) {
    auto* landmarks = app.add_subcommand(
        "landmarks", "Results of a stationary lidar: landmarks while a door moves, sweeps of tolerance, readings and "
                     "filter, as a report");
    landmarks->add_option("--out", options.out, kOutHelp);
    landmarks->add_option("--seed", options.seed, kSeedHelp)->check(check_whole_number_from(0))->capture_default_str();
    landmarks->add_option("--scenes", [](const auto&) { return true; })->group(""); // until 2.0; has no effect
    landmarks
        ->add_option("--capture", options.capture,
                     "File with the bytes of a stationary LD06, at least two turns; adds a part to the report")
        ->check(&check_not_empty)
        ->type_name("FILE");
    return landmarks;
}

CLI::App* add_score(CLI::App& app, ScoreOptions& options, std::string& poses) {
    auto* score = app.add_subcommand(
        "score",
        "Estimates the trajectory of a recorded log and compares it with verified relative poses: the errors in "
        "metres and degrees, and the time per scan");
    score->add_option("LOG", options.log, "CARMEN log, plain, gzip or bzip2")->configurable(false);
    score->add_option("RELATIONS", options.relations, "Lines of: t1 t2 x y z roll pitch yaw, in s, m and radians")
        ->configurable(false);
    add_checked(*score, "--poses", poses,
                "Whether the log's odometry is used, or none of its poses. FLASER: the second pose is the odometry",
                CLI::IsMember({"odometry", "none"}));
    score->add_option("--trajectory", options.trajectory, "File for the final poses, in the TUM format; overwritten")
        ->check(&check_not_empty)
        ->type_name("FILE");
    Perturbation& perturbation = options.perturbation;
    add_checked(*score, "--odometry-scale", perturbation.odometry_scale,
                "Factor of each motion of the odometry, to test robustness", check_within(0.5, 2.0));
    score->add_option("--every", perturbation.every, "Use only every N-th scan")
        ->check(check_whole_number_from(1))
        ->capture_default_str()
        ->type_name("N");
    score->add_option("--skip", perturbation.skip, "Leave out the first N scans")
        ->check(check_whole_number_from(0))
        ->capture_default_str()
        ->type_name("N");
    return score;
}

CLI::App* add_localization(CLI::App& app, LocalizationOptions& options, std::vector<std::string>& files) {
    auto* localization = app.add_subcommand(
        "localization", "Estimates the trajectories of recorded logs with and without their odometry and with changes "
                        "that must not matter: errors, published errors, false loops and maps, as a report");
    localization->add_option("--out", options.out, kOutHelp);
    localization
        ->add_option("FILES", files,
                     "Pairs of files: a CARMEN log (plain, gzip or bzip2), and its verified relative poses, lines of: "
                     "t1 t2 x y z roll pitch yaw")
        ->type_name("LOG RELATIONS ...")
        ->configurable(false);
    return localization;
}

/// Adds an option for a whole number from 1 to `most`.
void add_count(CLI::App& app, const std::string& name, std::size_t& into, std::size_t most, const std::string& help) {
    add_checked(app, name, into, help, check_within(1, static_cast<double>(most)))->check(check_whole_number_from(1));
}

void add_load_of_cluster(CLI::App& app, cluster::Plan& plan) {
    add_count(app, "--robots", plan.robots, 1'000'000, "Robots, 1 to 1000000");
    add_checked(app, "--rate", plan.rate_hz, "Scans of a robot per second, up to 1000", check_above_up_to(0, 1000));
    add_checked(app, "--session-size", plan.session_size, "Robots of a session, mean, 1 to 1024",
                check_within(1, cluster::kSessionSizeMax));
    add_checked(app, "--session-spread", plan.session_spread,
                "Standard deviation of the logarithm of a session's size, 0 to 3; 0: all are equal",
                check_within(0, 3));
    add_checked(app, "--session-life", plan.session_life_hours,
                "Hours until a session's robots start again with another session, mean; 0: never",
                check_within(0, 1e6));
}

void add_machines_of_cluster(CLI::App& app, cluster::Plan& plan) {
    add_count(app, "--nodes", plan.nodes, 4096, "Nodes, 1 to 4096");
    add_checked(app, "--node-cores", plan.node_cores, "Cores of a node", check_above_up_to(0, 1024));
    add_checked(app, "--node-us", plan.node_us, "Processor time of a node for a scan, in us",
                check_above_up_to(0, 1e6));
    add_checked(app, "--load-ms", plan.load_ms, "Time for loading a session that another node had, in ms, up to 10000",
                check_within(0, 10'000));
    add_checked(app, "--close-ms", plan.close_ms,
                "Time for the checkpoint of a session that a stopped node gives up, in ms, up to 10000",
                check_within(0, 10'000));
    add_checked(app, "--database-cores", plan.database_cores, "Cores of a primary", check_above_up_to(0, 1024));
    add_checked(app, "--database-mb", plan.database_mbytes,
                "MB (10^6 bytes) of log that a primary may write per second", check_above_up_to(0, 1e6));
    add_checked(app, "--primary-us", plan.primary_us, "Processor time of the primary for a scan, in us",
                check_above_up_to(0, 1e6));
    add_checked(app, "--standby-us", plan.standby_us, "Processor time of the standby for a scan, in us",
                check_within(0, 1e6));
    add_checked(app, "--log-bytes", plan.log_bytes, "Bytes of a scan in the log", check_above_up_to(0, 1e6));
}

void add_events_of_cluster(CLI::App& app, cluster::Plan& plan, std::optional<double>& upgrade_at) {
    add_checked(app, "--failure-every", plan.failure_hours, "Hours between failures of a node, mean; 0: no failures",
                check_within(0, 1e6));
    add_checked(app, "--silent", plan.silent_share,
                "Share of failures that close no connection, as a loss of power, 0 to 1", check_within(0, 1));
    add_checked(app, "--repair", plan.repair_minutes, "Minutes from a failure until the node is back, 1 or more",
                check_within(1, 1e6));
    app.add_option("--upgrade-at", upgrade_at,
                   "Hour in which an upgrade begins to restart the nodes, one after another; 0: none; default: half of "
                   "--duration")
        ->check(check_within(0, 1e6));
    add_checked(app, "--restart", plan.restart_s, "Seconds from a node's stop until it is ready, 1 to 3600",
                check_within(1, 3600));
    add_checked(app, "--duration", plan.duration_hours, "Simulated hours, 0.02 to 10000", check_within(0.02, 10'000));
    app.add_option("--seed", plan.seed, "Seed of all random numbers; the same seed gives the same output")
        ->check(check_whole_number_from(0))
        ->capture_default_str();
}

CLI::App* add_cluster(CLI::App& app, cluster::Plan& plan, std::optional<double>& upgrade_at) {
    auto* command = app.add_subcommand(
        "cluster", "Simulates several nodes on a shared database: placement of sessions, failures, an upgrade, and how "
                   "many machines are needed");
    add_load_of_cluster(*command, plan);
    add_machines_of_cluster(*command, plan);
    add_events_of_cluster(*command, plan, upgrade_at);
    return command;
}

/// Completes the plan. @return what is wrong with it; empty if nothing is
std::string complete(cluster::Plan& plan, std::optional<double> upgrade_at) {
    plan.upgrade_at_hours = upgrade_at.value_or(plan.duration_hours / 2.0);
    const auto possible = cluster::check(plan);
    return possible ? std::string() : "cluster: " + possible.error().message;
}

/// Returns what is wrong with the files of localization; empty if nothing is.
std::string complaint_about(const std::vector<LogFiles>& files, std::size_t words) {
    if (words == 0 || words % 2 != 0) return "localization: name pairs of files, LOG RELATIONS";
    for (std::size_t n = 0; n < files.size(); ++n) {
        for (std::size_t other = 0; other < n; ++other) {
            if (name_of_log(files[n].log) != name_of_log(files[other].log)) continue;
            return fmt::format("localization: {} and {} would have the same pictures; rename one of them",
                               files[other].log, files[n].log);
        }
    }
    return {};
}

/// Returns what is wrong with the options of score; empty if nothing is.
std::string complaint_about(const ScoreOptions& options) {
    if (options.log.empty() || options.relations.empty()) return "score: name two files, LOG and RELATIONS";
    if (options.poses == Poses::kNone && options.perturbation.odometry_scale != 1.0) {
        return "score: --odometry-scale has no effect with --poses none; leave out one of them";
    }
    return {};
}

} // namespace

std::variant<Options, Leave> parse_options(int argc, const char* const* argv) {
    ExperimentOptions experiment_options;
    LandmarkOptions landmark_options;
    ScoreOptions score_options;
    LocalizationOptions localization_options;
    cluster::Plan cluster_plan;
    std::optional<double> cluster_upgrade_at; // hours
    std::string poses = "odometry";
    std::vector<std::string> files;
    CLI::App app(kAbout, "scanloom-lab");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-lab {}", kVersion));
    add_experiment(app, experiment_options);
    const auto* landmarks = add_landmarks(app, landmark_options);
    const auto* score = add_score(app, score_options, poses);
    const auto* localization = add_localization(app, localization_options, files);
    const auto* cluster = add_cluster(app, cluster_plan, cluster_upgrade_at);
    app.require_subcommand(1);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason, "name a command: experiment, landmarks, score, localization or cluster");
    }
    if (score->parsed()) {
        score_options.poses = poses == "none" ? Poses::kNone : Poses::kOdometry;
        if (auto wrong = complaint_about(score_options); !wrong.empty()) return usage_error(app, wrong);
        return score_options;
    }
    if (localization->parsed()) {
        if (localization_options.out.empty()) return usage_error(app, "localization: name a directory with --out");
        for (std::size_t n = 0; n + 1 < files.size(); n += 2) {
            localization_options.files.push_back({files[n], files[n + 1]});
        }
        const auto wrong = complaint_about(localization_options.files, files.size());
        if (!wrong.empty()) return usage_error(app, wrong);
        return localization_options;
    }
    if (cluster->parsed()) {
        if (auto wrong = complete(cluster_plan, cluster_upgrade_at); !wrong.empty()) return usage_error(app, wrong);
        return cluster_plan;
    }
    // --out is not required() by the parser, so that its error message can be ours
    if (landmarks->parsed()) {
        if (landmark_options.out.empty()) return usage_error(app, "landmarks: name a directory with --out");
        return landmark_options;
    }
    if (experiment_options.out.empty()) return usage_error(app, "experiment: name a directory with --out");
    return experiment_options;
}

} // namespace scanloom::lab
