#include "server/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/machine.hpp"
#include "common/app/settings.hpp"
#include "common/text/parse_number.hpp"
#include "server/app/places.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/token_command.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
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
constexpr double kTileCacheMibMax = 1024.0 * 1024.0;

constexpr double kMapMemoryMibMin = 64.0;
constexpr double kMapMemoryMibMax = 1024.0 * 1024.0 * 1024.0;
constexpr double kIdleAfterMax = 365.0 * 24 * 3600;

/// The settings as parsed, before they are validated and converted.
struct Raw {
    std::string listen = "127.0.0.1:7447";
    std::string http = "127.0.0.1:8080";
    std::string store;
    std::string check;   ///< "log" or "deep"; empty: not given
    std::string restore; ///< "newest", or an id; empty: not given
    std::string tokens;  ///< empty: not given
    std::string web;     ///< empty: not given
    std::vector<std::string> proxies;
    double tile_cache_mib = 64.0;
    double map_memory_mib = 0.0;
    double replay_memory_mib = 0.0;
    double disk_reserve_mib = 256.0;
    double idle_after = 600.0;
};

/// Returns where a package installs the viewer, if it exists there; otherwise its place in the build directory.
std::filesystem::path default_web() {
    std::error_code ignored;
    const auto programs = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    const auto installed = programs.parent_path() / "share" / "scanloom" / "web";
    return std::filesystem::exists(installed, ignored) ? installed : programs.parent_path() / "web";
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

void add_options(CLI::App& app, ServerOptions& options, Raw& raw) {
    app.add_option("--listen", raw.listen, "Address and port for robots; port 0 picks a free one")
        ->capture_default_str();
    app.add_flag("--check{log}", raw.check,
                 "Read the whole store, report damage, and exit; changes nothing. No server may have the store open. "
                 "--check=deep also computes the maps of every log again and compares them")
        ->check(CLI::IsMember({"log", "deep"}));
    auto* backups = app.add_option("--backups", options.backups,
                                   "Directory for backups of the store, best on another disk; POST /api/v1/backups "
                                   "creates one while the server runs");
    app.add_option("--backups-kept", options.backups_kept, "Number of backups kept, the newest ones")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    auto* repair = app.add_option("--repair", options.repaired,
                                  "Write the intact parts of a damaged store to a new store, and exit; --store is the "
                                  "damaged store, which is not changed")
                       ->excludes("--check");
    app.add_option("--restore", raw.restore,
                   "Write the store of a backup, given by its number or 'newest', and exit; --store must be empty")
        ->needs(backups)
        ->excludes("--check")
        ->excludes(repair);
    app.add_option("--http", raw.http, "Address and port for browsers and API clients")->capture_default_str();
    app.add_option("--store", raw.store, "Directory of the log; created if it does not exist")->required();
    app.add_option(
           "--http-host", options.http_hosts,
           "Host name of the HTTP port, in addition to localhost and addresses; separate several names by commas, or "
           "repeat the option. Other names are refused on a loopback address, and on all addresses if one is given")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option(
           "--http-proxy", raw.proxies,
           "Address of a reverse proxy; separate several addresses by commas, or repeat the option. It may open any "
           "number of connections to the HTTP port; other remote addresses may open 256")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_tls_options(app, options.robot_tls, "--robot", "robots");
    add_tls_options(app, options.http_tls, "--http", "browsers and programs");
    app.add_option(
        "--tokens", raw.tokens,
        "File of the tokens and their permissions (TOML); without it, every client may do everything. SIGHUP makes "
        "the server read it again");
    app.add_option("--web", raw.web, "Directory of the viewer's files; it contains index.html");
    app.add_option("--threads", options.threads,
                   "Number of threads that compute maps; the same number answers requests")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    app.add_option("--tile-cache", raw.tile_cache_mib, "MiB of tiles that are cached; 0 disables the cache")
        ->check(check_within(0.0, kTileCacheMibMax))
        ->capture_default_str();
    app.add_option(
           "--disk-reserve", raw.disk_reserve_mib,
           "MiB to keep free on the store's disk; with less, the server stores nothing until space is free again")
        ->check(check_within(0.0, kTileCacheMibMax))
        ->capture_default_str();
    app.add_option("--map-memory", raw.map_memory_mib,
                   "MiB for the maps of all sessions together; when they are used up, unused sessions are evicted from "
                   "memory. Default: half of the available memory")
        ->check(check_within(kMapMemoryMibMin, kMapMemoryMibMax))
        ->capture_default_str();
    app.add_option(
           "--weave-memory", raw.replay_memory_mib,
           "MiB for the maps of all replay jobs (other settings, earlier revisions) together: half for running jobs, "
           "half for cached maps. Default: a quarter of the available memory")
        ->check(check_within(kMapMemoryMibMin, kMapMemoryMibMax))
        ->capture_default_str();
    app.add_option("--idle-after", raw.idle_after,
                   "Seconds after which an unused session is evicted from memory; the next request loads it again")
        ->check(check_within(1.0, kIdleAfterMax))
        ->capture_default_str();
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

/// Sets the directory of the viewer. A directory that was named must have an index.html; the default one may be
/// missing.
Result<> settle_web(const std::string& named, ServerOptions& options) {
    options.web = named.empty() ? default_web() : std::filesystem::path(named);
    std::error_code ignored;
    if (named.empty() || std::filesystem::is_regular_file(options.web / "index.html", ignored)) return {};
    return Error{Errc::kNotFound, fmt::format("--web {}: the directory has no index.html; give the directory that the "
                                              "viewer was built into, or omit --web",
                                              named)};
}

Result<> check_host_names(const std::vector<std::string>& names) {
    for (const auto& name : names) {
        const bool valid = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
            return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
        });
        if (valid) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("--http-host '{}' is not a host name; write it without scheme and port", name)};
    }
    return {};
}

Result<> settle_proxies(const std::vector<std::string>& named, ServerOptions& options) {
    for (const auto& text : named) {
        boost::system::error_code failed;
        options.http_proxies.push_back(boost::asio::ip::make_address(text, failed));
        if (!failed) continue;
        return Error{Errc::kInvalidField, fmt::format("--http-proxy '{}' is not an address; write 192.0.2.7", text)};
    }
    return {};
}

Result<> settle_task(const Raw& raw, ServerOptions& options) {
    if (!raw.check.empty()) options.task = raw.check == "deep" ? Task::kCheckMaps : Task::kCheck;
    if (!options.repaired.empty()) options.task = Task::kRepair;
    if (raw.restore.empty()) return {};
    options.task = Task::kRestore;
    if (raw.restore == "newest") return {};
    options.backup = parse_number<std::uint32_t>(raw.restore);
    if (options.backup.value_or(0) > 0) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("--restore '{}' is not a backup; give its number, or 'newest'", raw.restore)};
}

Result<> settle(const Raw& raw, ServerOptions& options) {
    const auto listen = parse_endpoint(raw.listen);
    if (!listen) return prefixed("--listen ", listen.error());
    options.listen = *listen;
    const auto http = parse_endpoint(raw.http);
    if (!http) return prefixed("--http ", http.error());
    options.http = *http;
    if (raw.store.find("://") != std::string::npos) {
        return Error{Errc::kInvalidField,
                     fmt::format("--store {}: this version keeps its log in a directory; give a path", raw.store)};
    }
    options.store = raw.store;
    if (auto task = settle_task(raw, options); !task) return task;
    if (auto apart = check_places(options); !apart) return apart;
    if (raw.disk_reserve_mib < kDiskReserveMibMin) {
        return Error{Errc::kInvalidField,
                     fmt::format("--disk-reserve {}: when the disk fills up, the store needs {} MiB to finish what it "
                                 "has begun; reserve at least that much",
                                 raw.disk_reserve_mib, kDiskReserveMibMin)};
    }
    options.disk_reserve_bytes = static_cast<std::uint64_t>(raw.disk_reserve_mib * 1024 * 1024);
    options.map_memory_bytes = static_cast<std::size_t>(raw.map_memory_mib * 1024 * 1024);
    options.replay_memory_bytes = static_cast<std::size_t>(raw.replay_memory_mib * 1024 * 1024);
    options.idle_after = std::chrono::milliseconds(static_cast<std::int64_t>(raw.idle_after * 1000));
    options.tokens = raw.tokens;
    options.tile_cache_bytes = static_cast<std::size_t>(raw.tile_cache_mib * 1024 * 1024);
    if (auto found = settle_web(raw.web, options); !found) return found.error();
    if (auto valid = check_host_names(options.http_hosts); !valid) return valid.error();
    if (auto valid = settle_proxies(raw.proxies, options); !valid) return valid.error();
    return check_guarded(options);
}

} // namespace

std::variant<ServerOptions, Leave> read_options(int argc, const char* const* argv) {
    if (auto made = token_command(argc, argv)) return std::move(*made);
    ServerOptions options;
    options.threads = std::max(1U, std::thread::hardware_concurrency());
    Raw raw;
    const auto memory = default_map_memory(memory_limit());
    raw.map_memory_mib = static_cast<double>(memory.maps >> 20);
    raw.replay_memory_mib = static_cast<double>(memory.replay_jobs >> 20);

    CLI::App app(kAbout, "scanloom-server");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-server {}", kVersion));
    add_options(app, options, raw);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason);
    }
    if (auto settled = settle(raw, options); !settled) return usage_error(app, settled.error().message);
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

namespace {

/// A port, and what protects it.
struct Guard {
    const char* flag;
    const boost::asio::ip::tcp::endpoint& endpoint;
    bool has_tokens;
    const sockets::TlsFiles& tls;
    const char* remedy; ///< the settings that would protect it, for a message

    [[nodiscard]] bool is_reached() const { return !endpoint.address().is_loopback(); }
};

std::array<Guard, 2> guards_of(const ServerOptions& options) {
    const bool has_tokens = !options.tokens.empty();
    return {{{"--listen", options.listen, has_tokens, options.robot_tls, "add --tokens or --robot-tls-cert"},
             {"--http", options.http, has_tokens, options.http_tls, "add --tokens or --http-tls-cert"}}};
}

} // namespace

Result<> check_guarded(const ServerOptions& options) {
    if (options.insecure) return {};
    for (const auto& guard : guards_of(options)) {
        if (!guard.is_reached() || guard.has_tokens || guard.tls.is_given()) continue;
        return Error{
            Errc::kInvalidField,
            fmt::format(
                "{} {} can be reached from other machines without tokens or TLS; {}; or listen on 127.0.0.1, or "
                "add --insecure if all of them may send and read",
                guard.flag, guard.endpoint.address().to_string(), guard.remedy)};
    }
    return {};
}

std::vector<std::string> guard_warnings(const ServerOptions& options) {
    std::vector<std::string> warnings;
    for (const auto& guard : guards_of(options)) {
        if (!guard.is_reached()) continue;
        if (!guard.tls.is_given() && guard.has_tokens) {
            warnings.push_back(
                fmt::format("{}: clients send tokens without TLS; everyone on the network path can read and "
                            "use them, and read all other data",
                            guard.flag));
        } else if (!guard.has_tokens) {
            const bool is_mutual = !guard.tls.client_ca.empty();
            warnings.push_back(fmt::format(
                "{}: no token is required; every client that {} can send and read everything{}", guard.flag,
                is_mutual ? "presents a certificate signed by " + guard.tls.client_ca.string() : "reaches it",
                guard.tls.is_given() ? "; others on the network path cannot" : ""));
        }
    }
    return warnings;
}

} // namespace scanloom::app
