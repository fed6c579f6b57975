#include "server/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/machine.hpp"
#include "common/app/settings.hpp"
#include "common/text/parse_number.hpp"
#include "server/app/guards.hpp"
#include "server/app/places.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/token_command.hpp"
#include "server/store/open_store.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <thread>

namespace scanloom::app {
namespace {

constexpr const char* kAbout = "Stores the scans of robots in a durable log and serves the maps computed from it.\n"
                               "Prints one line of JSON with its ports when it is ready.";
constexpr const char* kFooter =
    "Every option can also be set in the file of --config (TOML) or in the environment "
    "(--log-level as SCANLOOM_LOG_LEVEL).\nA flag overrides the environment, which overrides the file.\n"
    "`scanloom-server token --help` describes how to create tokens.";

// When scans filled a disk of 200 MiB, RocksDB had no room for a table with a reserve of 16 MiB, and had it with 32.
constexpr double kDiskReserveMibMin = 32.0;
constexpr double kDiskReserveMibMax = 1024.0 * 1024.0; // 1 TiB

constexpr double kStoreMibMax = 1024.0 * 1024.0 * 1024.0; // 1 PiB
constexpr double kTileCacheMibMax = 1024.0 * 1024.0;      // 1 TiB
constexpr double kMapMemoryMibMin = 64.0;
constexpr double kMapMemoryMibMax = 1024.0 * 1024.0 * 1024.0; // 1 PiB
constexpr double kIdleAfterMax = 365.0 * 24 * 3600;           // seconds: one year

/// Returns where a package installs the viewer, if it exists there; otherwise its place in the build directory.
std::filesystem::path default_web() {
    std::error_code ignored;
    const auto programs = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    const auto installed = programs.parent_path() / "share" / "scanloom" / "web";
    return std::filesystem::exists(installed, ignored) ? installed : programs.parent_path() / "web";
}

// Checks for CLI::Option::check(): the error, or an empty text.

std::string check_store(const std::string& text) {
    const bool is_address = store::is_in_database(text);
    if (!is_address && text.find("://") == std::string::npos) return "";
    if (!is_address)
        return "this is neither a directory nor a database; write PATH, or postgresql://USER@HOST/DATABASE";
    const auto place = store::check_address(text);
    return place ? "" : place.error().message;
}

std::string check_viewer(const std::string& directory) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(std::filesystem::path(directory) / "index.html", ignored)) return "";
    return fmt::format("{} has no index.html; give the directory that the viewer was built into, or omit --web",
                       directory);
}

std::string check_host_name(const std::string& name) {
    const bool valid = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
    });
    return valid ? "" : fmt::format("'{}' is not a host name; write it without scheme and port", name);
}

std::string check_node(const std::string& name) {
    constexpr std::size_t kLength = 100;
    const bool valid = !name.empty() && name.size() <= kLength &&
                       std::ranges::all_of(name, [](unsigned char c) { return c > ' ' && c <= '~'; });
    return valid ? ""
                 : fmt::format("'{}' is not a name of a server; write 1 to {} visible ASCII characters", name, kLength);
}

std::string check_origin(const std::string& text) {
    const auto scheme_end = text.find("://");
    const bool is_origin = scheme_end != std::string::npos && scheme_end > 0 &&
                           text.find_first_of("/?# ", scheme_end + 3) == std::string::npos;
    if (is_origin || text == "none") return "";
    return fmt::format("'{}' is not an origin; write scheme, name and port of the page as in https://maps.example:8443",
                       text);
}

std::string check_address(const std::string& text) {
    boost::system::error_code failed;
    boost::asio::ip::make_address(text, failed);
    return failed ? fmt::format("'{}' is not an address; write 192.0.2.7", text) : "";
}

/// Returns the number of a backup, or nullopt for the newest one.
Result<std::optional<std::uint32_t>> parse_backup(const std::string& text) {
    if (text == "newest") return std::optional<std::uint32_t>();
    const auto number = parse_number<std::uint32_t>(text);
    if (number.value_or(0) > 0) return number;
    return Error{Errc::kInvalidField, fmt::format("'{}' is not a backup; give its number, or 'newest'", text)};
}

/// @param port  prefix of the port's options
/// @param who   the clients of the port, for the help text
void add_tls_options(CLI::App& app, sockets::TlsFiles& files, const std::string& port, const std::string& who) {
    auto* certificate = app.add_option(
        port + "-tls-cert", files.certificate,
        fmt::format(
            "Certificate chain in PEM: {} must use TLS, and can verify the server. SIGHUP makes the server read it "
            "again",
            who));
    auto* key = app.add_option(port + "-tls-key", files.key, "Its private key in PEM, without a password");
    certificate->needs(key);
    key->needs(certificate);
    app.add_option(
           port + "-client-ca", files.client_ca,
           fmt::format(
               "CA certificates in PEM: {} must present a certificate signed by one of them. SIGHUP makes the server "
               "read it again",
               who))
        ->needs(certificate);
}

/// Adds an option in MiB, whose default is the current value of `bytes`.
template <class Bytes>
CLI::Option* add_mib_option(CLI::App& app, const std::string& name, Bytes& bytes, const std::string& help, double low,
                            double high) {
    const auto assign = [&bytes](double mib) { bytes = static_cast<Bytes>(mib * 1024 * 1024); };
    return app.add_option_function<double>(name, assign, help)
        ->check(check_within(low, high))
        ->default_str(fmt::format("{}", bytes >> 20));
}

/// Adds the options that select another task than to serve.
void add_task_options(CLI::App& app, ServerOptions& options) {
    const std::string about_check =
        "Read the whole store, report damage, and exit; changes nothing. No server may have the store open. "
        "--check=deep also computes the maps of every log again and compares them";
    app.add_flag("--check{log}", about_check)
        ->check(CLI::IsMember({"log", "deep"}))
        ->each([&](const std::string& text) { options.task = text == "deep" ? Task::kCheckMaps : Task::kCheck; });
    auto* backups = app.add_option("--backups", options.backups,
                                   "Directory for backups of the store, best on another disk; POST /api/v1/backups "
                                   "creates one while the server runs");
    app.add_option("--backups-kept", options.backups_kept, "Number of backups kept, the newest ones")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    auto* repair = app.add_option("--repair", options.repaired,
                                  "Write the intact parts of a damaged store to a new store, and exit; --store is the "
                                  "damaged store, which is not changed")
                       ->excludes("--check")
                       ->each([&](const std::string&) { options.task = Task::kRepair; });
    auto* to = app.add_option("--to", options.copied, "The new store of --copy: a directory or a database")
                   ->check(&check_store);
    auto* copy =
        app.add_option("--copy", options.store,
                       "Copy a store that no server has open to a new one, and exit; both can be directories or "
                       "databases")
            ->check(&check_store)
            ->needs(to)
            ->excludes("--check")
            ->excludes(repair)
            ->each([&](const std::string&) { options.task = Task::kCopy; });
    to->needs(copy);
    add_parsed(app, "--restore", options.backup,
               "Write the store of a backup, given by its number or 'newest', and exit; --store must be empty",
               parse_backup)
        ->needs(backups)
        ->excludes("--check")
        ->excludes(repair)
        ->excludes(copy)
        ->each([&](const std::string&) { options.task = Task::kRestore; });
}

void add_http_options(CLI::App& app, ServerOptions& options) {
    add_parsed(app, "--http", options.http, "Address and port for browsers and API clients", parse_endpoint)
        ->default_str(fmt::format("{}", fmt::streamed(options.http)));
    app.add_option(
           "--http-host", options.http_hosts,
           "Host name of the HTTP port, in addition to localhost and addresses; separate several names by commas, or "
           "repeat the option. Other names are refused on a loopback address, and on all addresses if one is given")
        ->check(&check_host_name)
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option(
           "--viewer-origin", options.viewer_origins,
           "Origin of a web page that may open .../foxglove, such as https://app.foxglove.dev; separate several "
           "by commas, or repeat the option. 'none': no page")
        ->check(&check_origin)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->capture_default_str();
    app.add_option_function<std::vector<std::string>>(
           "--http-proxy",
           [&](const auto& texts) {
               for (const auto& text : texts) options.http_proxies.push_back(boost::asio::ip::make_address(text));
           },
           "Address of a reverse proxy; separate several addresses by commas, or repeat the option. It may open any "
           "number of connections to the HTTP port; other remote addresses may open 256")
        ->check(&check_address)
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--web", options.web, "Directory of the viewer's files; it contains index.html")
        ->check(&check_viewer);
}

void add_memory_options(CLI::App& app, ServerOptions& options) {
    add_mib_option(app, "--tile-cache", options.tile_cache_bytes, "MiB of tiles that are cached; 0 disables the cache",
                   0.0, kTileCacheMibMax);
    add_mib_option(
        app, "--disk-reserve", options.disk_reserve_bytes,
        "MiB to keep free on the store's disk; with less, the server stores nothing until space is free again", 0.0,
        kDiskReserveMibMax)
        ->check(check_number(fmt::format("enough: when the disk fills up, the store needs {} MiB to finish what it has "
                                         "begun; reserve at least that much",
                                         kDiskReserveMibMin),
                             [](double mib) { return mib >= kDiskReserveMibMin; }));
    add_mib_option(app, "--map-memory", options.map_memory_bytes,
                   "MiB for the maps of all sessions together; when they are used up, unused sessions are evicted from "
                   "memory. Default: half of the available memory",
                   kMapMemoryMibMin, kMapMemoryMibMax);
    add_mib_option(
        app, "--weave-memory", options.replay_memory_bytes,
        "MiB for the maps of all replay jobs (other settings, earlier revisions) together: half for running jobs, "
        "half for cached maps. Default: a quarter of the available memory",
        kMapMemoryMibMin, kMapMemoryMibMax);
    const auto set_idle = [&](double seconds) {
        options.idle_after = std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
    };
    app.add_option_function<double>(
           "--idle-after", set_idle,
           "Seconds after which an unused session is evicted from memory; the next request loads it again")
        ->check(check_within(1.0, kIdleAfterMax))
        ->default_str(fmt::format("{}", options.idle_after.count() / 1000));
}

void add_options(CLI::App& app, ServerOptions& options) {
    add_parsed(app, "--listen", options.listen, "Address and port for robots; port 0 picks a free one", parse_endpoint)
        ->default_str(fmt::format("{}", fmt::streamed(options.listen)));
    app.add_option("--store", options.store,
                   "Directory of the log; created if it does not exist. Or a database of PostgreSQL 15 or newer, "
                   "postgresql://USER@HOST[,HOST...]/DATABASE")
        ->check(&check_store);
    app.add_flag("--allow-unreplicated", options.allow_unreplicated,
                 "Accept a database without a synchronous standby: the loss of its machine loses acknowledged scans");
    const auto limit_store = [&](double mib) {
        options.store_bytes_max = static_cast<std::uint64_t>(mib * 1024 * 1024);
    };
    app.add_option_function<double>("--store-size-max", limit_store,
                                    "MiB of entries and checkpoints in a database; with more, the server stores "
                                    "nothing until sessions are removed")
        ->check(check_within(1.0, kStoreMibMax));
    app.add_option("--node", options.node,
                   "Name of this server among those that share a database, which a later start must repeat to have its "
                   "sessions at once")
        ->check(&check_node)
        ->default_str("HOST:PORT of --listen");
    add_task_options(app, options);
    add_http_options(app, options);
    add_tls_options(app, options.robot_tls, "--robot", "robots");
    add_tls_options(app, options.http_tls, "--http", "browsers and programs");
    app.add_option(
        "--tokens", options.tokens,
        "File of the tokens and their permissions (TOML); without it, every client may do everything. SIGHUP makes "
        "the server read it again");
    app.add_option("--threads", options.threads,
                   "Number of threads that compute maps; the same number answers requests")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    add_memory_options(app, options);
    app.add_option("--log-level", options.log_level, "Minimum level of the lines on standard error")
        ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
        ->capture_default_str();
    app.add_option("--log-format", options.log_format,
                   "Lines for people, or objects of JSON with fields for session, robot and peer")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    app.add_flag(
        "--insecure", options.insecure,
        "Allow other machines to connect although a port has neither tokens nor TLS: all of them may send and read");
}

} // namespace

std::variant<ServerOptions, Leave> read_options(int argc, const char* const* argv) {
    if (auto made = token_command(argc, argv)) return std::move(*made);
    ServerOptions options;
    options.threads = std::max(1U, std::thread::hardware_concurrency());
    const auto memory = default_map_memory(memory_limit());
    options.map_memory_bytes = memory.maps >> 20 << 20; // whole MiB, as --help shows
    options.replay_memory_bytes = memory.replay_jobs >> 20 << 20;

    CLI::App app(kAbout, "scanloom-server");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-server {}", kVersion));
    add_options(app, options);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason);
    }
    const bool has_store = app.count("--store") > 0;
    if (!has_store && options.task != Task::kCopy) return usage_error(app, "--store is required");
    if (has_store && options.task == Task::kCopy) return usage_error(app, "--copy names the store; leave --store out");
    if (options.web.empty()) options.web = default_web();
    if (auto apart = check_places(options); !apart) return usage_error(app, apart.error().message);
    if (auto guarded = check_guarded(options); !guarded) return usage_error(app, guarded.error().message);
    return options;
}

Result<boost::asio::ip::tcp::endpoint> parse_endpoint(const std::string& text) {
    const Error malformed{Errc::kInvalidField,
                          fmt::format("'{}' is not an address and port; write 127.0.0.1:8080 or [::1]:8080", text)};
    const auto colon = text.rfind(':');
    if (colon == std::string::npos) return malformed;
    std::string host = text.substr(0, colon);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    boost::system::error_code failed;
    const auto address = boost::asio::ip::make_address(host, failed);
    const auto port = parse_number<std::uint16_t>(std::string_view(text).substr(colon + 1));
    if (failed || !port) return malformed;
    return boost::asio::ip::tcp::endpoint(address, *port);
}

} // namespace scanloom::app
