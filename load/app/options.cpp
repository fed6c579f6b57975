#include "load/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/settings.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/uplink/limits.hpp"
#include "sim/robot/world_file.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace scanloom::load {
namespace {

constexpr const char* kAbout =
    "Puts a Scanloom server under load: many robots stream simulated scans at a fixed rate, with viewers and tile\n"
    "readers at the same time. Measures the latency of acknowledgements from the intended time of each scan, and\n"
    "verifies at the end that no scan was lost. Deletes the sessions that it created.\n"
    "Exits 0 if every scan was acknowledged and stored, 1 if not, 2 on invalid arguments.";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML) or in the environment (--cell-size as\n"
    "SCANLOOM_CELL_SIZE). A flag overrides the environment, which overrides the file.";

constexpr double kRobotsMax = 100'000;
constexpr double kRateMax = 1000.0;
constexpr double kSecondsMax = 1e6;
constexpr double kThreadsMax = 64;
constexpr double kOnlookersMax = 1000;

Result<HttpAddress> parse_http(std::string_view text) {
    constexpr std::string_view kScheme = "https://";
    const bool has_tls = text.starts_with(kScheme);
    const auto address = net::parse_address(text.substr(has_tls ? kScheme.size() : 0));
    if (address) return HttpAddress{*address, has_tls};
    return Error{Errc::kInvalidField, fmt::format("'{}' is not HOST:PORT, nor https://HOST:PORT", text)};
}

Result<Poses> parse_poses(std::string_view text) {
    if (const auto poses = find_poses(text)) return *poses;
    return Error{Errc::kInvalidField, fmt::format("'{}' is not map, odometry or none", text)};
}

template <class Number>
void add_count(CLI::App& app, const char* name, Number& into, const char* help, double low, double high) {
    add_checked(app, name, into, help, check_within(low, high))->check(check_whole_number_from(0));
}

void add_load_options(CLI::App& app, LoadOptions& options) {
    add_count(app, "--robots", options.robots, "Number of robots", 1, kRobotsMax);
    app.add_option("--sessions", options.sessions,
                   "Number of sessions for them. Default: one per robot, so that maps can be compared")
        ->check(check_within(1, kRobotsMax))
        ->check(check_whole_number_from(0));
    add_checked(app, "--rate", options.rate,
                "Scans per second of each robot; 0 = as fast as the server's credit permits",
                check_within(0.0, kRateMax));
    add_count(app, "--batch", options.batch, "Scans per frame; the first waits for the last", 1,
              static_cast<double>(kScansPerBatchMax));
    add_checked(app, "--duration", options.duration, "Seconds of sending, in addition to connecting and verifying",
                check_above_up_to(0.0, kSecondsMax));
    add_checked(app, "--connections-per-second", options.connections_per_second, "Robots that connect per second",
                check_within(1.0, 1e5));
    add_checked(app, "--give-up-after", options.give_up_after,
                "Seconds without any ack after which the run ends, while connecting and after the last scan",
                check_above_up_to(0.0, kSecondsMax));
    add_count(app, "--threads", options.threads, "Threads of the robots; use more if one falls behind", 1, kThreadsMax);
}

void add_scan_options(CLI::App& app, LoadOptions& options) {
    add_checked(app, "--world", options.world,
                "Where the robots drive: room, room_walker, office, hall, or FILE.yaml, a map of ROS",
                sim::check_world);
    add_checked(app, "--laser", options.laser,
                "Their laser: 684 beams over 180 degrees and 5 m; 360 over 360 degrees and 12 m; 1081 over 270 "
                "degrees and 30 m",
                CLI::IsMember({"reference", "lidar360", "wide"}));
    add_checked(app, "--noise", options.noise, "Noise of their measurements", CLI::IsMember({"none", "gaussian"}));
    add_parsed(
        app, "--poses", options.poses,
        "What they send with their scans: map = true poses; odometry = odometry that drifts; none = nothing. The "
        "server estimates the poses of the latter two",
        parse_poses)
        ->default_str("map");
    add_checked(app, "--seed", options.seed, "The same seed gives the same scans, faults and names of sessions",
                check_whole_number_from(0));
    add_count(
        app, "--course", options.course,
        "Scans of their trajectory, simulated before the start; they drive it to its end and back, again and again", 1,
        1e5);
    app.add_option("--cell-size", options.cell_size, "Cell size of the maps, metres. Default: the server's")
        ->check(check_within(robot::kCellSizeMin, robot::kCellSizeMax));
}

void add_onlooker_options(CLI::App& app, LoadOptions& options) {
    add_count(app, "--viewers", options.viewers, "Viewers that watch over WebSockets", 0, kOnlookersMax);
    add_count(app, "--tile-readers", options.tile_readers, "Readers that fetch the tiles of a session repeatedly", 0,
              kOnlookersMax);
    add_checked(app, "--tile-rate", options.tile_rate, "Tiles per second of each reader", check_within(0.1, kRateMax));
}

void add_end_options(CLI::App& app, LoadOptions& options, std::string& verify) {
    app.add_option("--faults", options.faults_text,
                   "Faults of links: kinds with the mean seconds between two faults of a link, as in "
                   "cut=20,half-open=60,stall=30")
        ->type_name("KIND=SECONDS,...");
    add_checked(app, "--verify", verify,
                "Verification at the end: each session has all acknowledged scans, and its maps equal those of an "
                "undisturbed session with the same scans",
                CLI::IsMember({"none", "counts", "digests"}));
    app.add_flag("--keep", options.keep, "Keep the sessions load-SEED-0, load-SEED-1, ... on the server");
    app.add_flag("--replace", options.replace, "First delete existing sessions with these names");
    app.add_option("--json", options.json_file,
                   "File for the report as JSON; - is standard output, instead of the text");
}

std::optional<std::string> sort_in(const std::string& verify, LoadOptions& options) {
    const auto faults = parse_faults(options.faults_text);
    if (!faults) return "--faults: " + faults.error().message;
    if (options.sessions > options.robots) {
        return fmt::format("--sessions: {} sessions need at least as many robots, but --robots is {}", options.sessions,
                           options.robots);
    }
    if (options.rate > 0.0 && options.rate * options.duration * options.robots > 1e15) return "--duration: too long";
    options.faults = *faults;
    if (options.sessions == 0) options.sessions = options.robots;
    options.verify = verify == "none" ? Verify::kNone : verify == "counts" ? Verify::kCounts : Verify::kDigests;
    return std::nullopt;
}

} // namespace

std::variant<LoadOptions, Leave> parse_options(int argc, const char* const* argv) {
    LoadOptions options;
    std::string verify = "digests";
    CLI::App app(kAbout, "scanloom-load");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-load {}", kVersion));
    add_link_options(app, options, "File with a token of the role operator, for the robots and for HTTP");
    add_parsed(app, "--http", options.http,
               "HTTP port of the server, HOST:PORT, or https://HOST:PORT if it has TLS: for viewers, verification, and "
               "its CPU use",
               parse_http)
        ->default_str(options.http.text());
    add_load_options(app, options);
    add_scan_options(app, options);
    add_onlooker_options(app, options);
    add_end_options(app, options, verify);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason);
    }
    if (auto mistake = sort_in(verify, options)) return usage_error(app, *mistake);
    return options;
}

} // namespace scanloom::load
