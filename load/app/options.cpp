#include "load/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/settings.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/sources/world_file.hpp"
#include "robot_client/uplink/limits.hpp"

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

/// As filled by the parser, before conversion to LoadOptions.
struct Raw {
    std::string server = "127.0.0.1:7447";
    std::string http = "127.0.0.1:8080";
    std::string verify = "digests";
};

template <class Number>
CLI::Option* add_count(CLI::App& app, const char* name, Number& into, const char* help, double low, double high) {
    return app.add_option(name, into, help)->check(check_within(low, high))->check(check_whole_number_from(0));
}

void add_link_options(CLI::App& app, LoadOptions& options, Raw& raw) {
    app.add_option("--server", raw.server, "Robot port of the server, HOST:PORT")->capture_default_str();
    app.add_option("--http", raw.http,
                   "HTTP port of the server, HOST:PORT, or https://HOST:PORT if it has TLS: for viewers, verification, "
                   "and its CPU use")
        ->capture_default_str();
    app.add_option("--token-file", options.token_file,
                   "File with a token of the role operator, for the robots and for HTTP")
        ->check(CLI::ExistingFile);
    app.add_flag("--tls", options.tls, "Encrypt the links, and verify that the server is the one that --server names");
    app.add_option("--tls-ca", options.tls_ca_file,
                   "File with the certificates to trust, in PEM, instead of the system's; means --tls")
        ->check(CLI::ExistingFile);
    auto* certificate =
        app.add_option(
               "--tls-cert", options.tls_cert_file,
               "File with the client certificate for servers that require one, in PEM, for both ports; means --tls")
            ->check(CLI::ExistingFile);
    auto* key = app.add_option("--tls-key", options.tls_key_file, "File with its private key, without a password")
                    ->check(CLI::ExistingFile);
    certificate->needs(key);
    key->needs(certificate);
}

void add_load_options(CLI::App& app, LoadOptions& options) {
    add_count(app, "--robots", options.robots, "Number of robots", 1, kRobotsMax)->capture_default_str();
    add_count(app, "--sessions", options.sessions,
              "Number of sessions for them. Default: one per robot, so that maps can be compared", 1, kRobotsMax);
    app.add_option("--rate", options.rate, "Scans per second of each robot; 0 = as fast as the server's credit permits")
        ->check(check_within(0.0, kRateMax))
        ->capture_default_str();
    add_count(app, "--batch", options.batch, "Scans per frame; the first waits for the last", 1,
              static_cast<double>(kScansPerBatchMax))
        ->capture_default_str();
    app.add_option("--duration", options.duration, "Seconds of sending, in addition to connecting and verifying")
        ->check(check_above_up_to(0.0, kSecondsMax))
        ->capture_default_str();
    app.add_option("--connections-per-second", options.connections_per_second, "Robots that connect per second")
        ->check(check_within(1.0, 1e5))
        ->capture_default_str();
    app.add_option("--give-up-after", options.give_up_after,
                   "Seconds without any ack after which the run ends, while connecting and after the last scan")
        ->check(check_above_up_to(0.0, kSecondsMax))
        ->capture_default_str();
    add_count(app, "--threads", options.threads, "Threads of the robots; use more if one falls behind", 1, kThreadsMax)
        ->capture_default_str();
}

std::string check_world(const std::string& world) {
    if (robot::is_world_file(world)) return {};
    const auto found = robot::find_world(world);
    return found ? "" : found.error().message + ", or the .yaml file of a ROS map";
}

void add_scan_options(CLI::App& app, LoadOptions& options) {
    app.add_option("--world", options.world,
                   "Where the robots drive: room, room_walker, office, hall, or FILE.yaml, a map of ROS")
        ->check(check_world)
        ->capture_default_str();
    app.add_option("--laser", options.laser,
                   "Their laser: 684 beams over 180 degrees and 5 m; 360 over 360 degrees and 12 m; 1081 over 270 "
                   "degrees and 30 m")
        ->check(CLI::IsMember({"reference", "lidar360", "wide"}))
        ->capture_default_str();
    app.add_option("--noise", options.noise, "Noise of their measurements")
        ->check(CLI::IsMember({"none", "gaussian"}))
        ->capture_default_str();
    app.add_option("--seed", options.seed, "The same seed gives the same scans, faults and names of sessions")
        ->check(check_whole_number_from(0))
        ->capture_default_str();
    add_count(app, "--course", options.course, "Scans of their trajectory, simulated before the start, then repeated",
              1, 1e5)
        ->capture_default_str();
    app.add_option("--cell-size", options.cell_size, "Cell size of the maps, metres. Default: the server's")
        ->check(check_within(robot::kCellSizeMin, robot::kCellSizeMax));
}

void add_onlooker_options(CLI::App& app, LoadOptions& options) {
    add_count(app, "--viewers", options.viewers, "Viewers that watch over WebSockets", 0, kOnlookersMax)
        ->capture_default_str();
    add_count(app, "--tile-readers", options.tile_readers, "Readers that fetch the tiles of a session repeatedly", 0,
              kOnlookersMax)
        ->capture_default_str();
    app.add_option("--tile-rate", options.tile_rate, "Tiles per second of each reader")
        ->check(check_within(0.1, kRateMax))
        ->capture_default_str();
}

void add_end_options(CLI::App& app, LoadOptions& options, Raw& raw) {
    app.add_option("--faults", options.faults_text,
                   "Faults of links: kinds with the mean seconds between two faults of a link, as in "
                   "cut=20,half-open=60,stall=30")
        ->type_name("KIND=SECONDS,...");
    app.add_option("--verify", raw.verify,
                   "Verification at the end: each session has all acknowledged scans, and its maps equal those of an "
                   "undisturbed session with the same scans")
        ->check(CLI::IsMember({"none", "counts", "digests"}))
        ->capture_default_str();
    app.add_flag("--keep", options.keep, "Keep the sessions load-SEED-0, load-SEED-1, ... on the server");
    app.add_flag("--replace", options.replace, "First delete existing sessions with these names");
    app.add_option("--json", options.json_file,
                   "File for the report as JSON; - is standard output, instead of the text");
}

std::optional<std::string> sort_in(const Raw& raw, LoadOptions& options) {
    const auto server = robot::parse_server_address(raw.server);
    if (!server) return fmt::format("--server: '{}' is not HOST:PORT", raw.server);
    constexpr std::string_view kScheme = "https://";
    options.http_tls = raw.http.starts_with(kScheme);
    const auto http = robot::parse_server_address(raw.http.substr(options.http_tls ? kScheme.size() : 0));
    if (!http) return fmt::format("--http: '{}' is not HOST:PORT, nor https://HOST:PORT", raw.http);
    const auto faults = parse_faults(options.faults_text);
    if (!faults) return "--faults: " + faults.error().message;
    if (options.sessions > options.robots) {
        return fmt::format("--sessions: {} sessions need at least as many robots, but --robots is {}", options.sessions,
                           options.robots);
    }
    if (options.rate > 0.0 && options.rate * options.duration * options.robots > 1e15) return "--duration: too long";
    options.server = *server;
    options.http = *http;
    options.faults = *faults;
    options.tls = options.tls || !options.tls_ca_file.empty() || !options.tls_cert_file.empty();
    if (options.sessions == 0) options.sessions = options.robots;
    options.verify = raw.verify == "none" ? Verify::kNone : raw.verify == "counts" ? Verify::kCounts : Verify::kDigests;
    return std::nullopt;
}

} // namespace

std::variant<LoadOptions, Leave> parse_options(int argc, const char* const* argv) {
    LoadOptions options;
    Raw raw;
    CLI::App app(kAbout, "scanloom-load");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-load {}", kVersion));
    add_link_options(app, options, raw);
    add_load_options(app, options);
    add_scan_options(app, options);
    add_onlooker_options(app, options);
    add_end_options(app, options, raw);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason);
    }
    if (auto mistake = sort_in(raw, options)) return usage_error(app, *mistake);
    return options;
}

} // namespace scanloom::load
