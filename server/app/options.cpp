#include "server/app/options.hpp"

#include "common/app/command_line.hpp"
#include "common/app/machine.hpp"
#include "common/app/settings.hpp"
#include "server/app/places.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/token_command.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <thread>

namespace scanloom::app {
namespace {

constexpr const char* kAbout = "Keeps the scans of robots in a durable log and serves the maps woven from it.\n"
                               "Prints one line of JSON with its ports when it is ready.";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML) or in the environment "
    "(--log-level as SCANLOOM_LOG_LEVEL).\nA flag beats the environment, which beats the file.\n"
    "`scanloom-server token --help` says how tokens are made.";

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
    std::string tokens;  ///< empty: not given; so for `web`
    std::string web;
    std::vector<std::string> proxies;
    double tile_cache_mib = 64.0;
    double map_memory_mib = 0.0;
    double weave_memory_mib = 0.0;
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
        fmt::format("Certificate chain in PEM: {} must speak TLS, and may check whom they speak to. SIGHUP has it read "
                    "again",
                    who));
    auto* key = app.add_option(port + "-tls-key", files.key, "Its private key in PEM, without a password");
    certificate->needs(key);
    key->needs(certificate);
    app.add_option(
           port + "-client-ca", files.client_ca,
           fmt::format("Certificates in PEM: {} must show one that these signed. SIGHUP has it read again", who))
        ->needs(certificate);
}

void add_options(CLI::App& app, ServerOptions& options, Raw& raw) {
    app.add_option("--listen", raw.listen, "Address and port for robots; port 0 picks a free one")
        ->capture_default_str();
    app.add_flag("--check{log}", raw.check,
                 "Read all of the store, say what is damaged, and end; changes nothing. No server may have it open. "
                 "--check=deep also weaves every log anew and compares the maps")
        ->check(CLI::IsMember({"log", "deep"}));
    auto* backups = app.add_option("--backups", options.backups,
                                   "Directory for backups of the store, best on another disk; POST /api/v1/backups "
                                   "makes one while the server runs");
    app.add_option("--backups-kept", options.backups_kept, "How many are kept, the newest")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    auto* repair = app.add_option("--repair", options.repaired,
                                  "Write whatever is intact of a damaged store into a new one, and end; --store is the "
                                  "damaged one, of which nothing is changed")
                       ->excludes("--check");
    app.add_option("--restore", raw.restore,
                   "Write the store as a backup has it, by its number or 'newest', and end; --store must be empty")
        ->needs(backups)
        ->excludes("--check")
        ->excludes(repair);
    app.add_option("--http", raw.http, "Address and port for people and programs")->capture_default_str();
    app.add_option("--store", raw.store, "Directory of the log; made if it does not exist")->required();
    app.add_option(
           "--http-host", options.http_hosts,
           "Name by which the HTTP port is asked, besides localhost and addresses; several with commas or several "
           "times. Other names are refused on a loopback address, and everywhere as soon as one is given")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--http-proxy", raw.proxies,
                   "Address of a reverse proxy; several with commas or several times. It may open any number of "
                   "connections to the HTTP port, other addresses of other machines 256")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_tls_options(app, options.robot_tls, "--robot", "robots");
    add_tls_options(app, options.http_tls, "--http", "browsers and programs");
    app.add_option("--tokens", raw.tokens,
                   "File that says who may do what (TOML); without it, whoever reaches a port may do everything. "
                   "SIGHUP has it read again");
    app.add_option("--web", raw.web, "Directory of the viewer's files; it holds index.html");
    app.add_option("--threads", options.threads, "Threads that weave maps, and as many that answer requests")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    app.add_option("--tile-cache", raw.tile_cache_mib,
                   "MiB of tiles that are kept, drawn and encoded, for whoever asks next; 0 keeps none")
        ->check(check_within(0.0, kTileCacheMibMax))
        ->capture_default_str();
    app.add_option("--disk-reserve", raw.disk_reserve_mib,
                   "MiB that are left free on the store's disk: with less, nothing more is stored until there is more")
        ->check(check_within(0.0, kTileCacheMibMax))
        ->capture_default_str();
    app.add_option(
           "--map-memory", raw.map_memory_mib,
           "MiB that the maps of all sessions may take together: sessions that nobody uses leave memory when it "
           "is used up. Default: half of the memory there is")
        ->check(check_within(kMapMemoryMibMin, kMapMemoryMibMax))
        ->capture_default_str();
    app.add_option("--weave-memory", raw.weave_memory_mib,
                   "MiB that maps woven anew, of other settings or earlier moments, may take together: half for those "
                   "under way, half for those that are kept. Default: a quarter of the memory there is")
        ->check(check_within(kMapMemoryMibMin, kMapMemoryMibMax))
        ->capture_default_str();
    app.add_option("--idle-after", raw.idle_after,
                   "Seconds after which a session that nobody uses leaves memory; it comes back when it is asked for")
        ->check(check_within(1.0, kIdleAfterMax))
        ->capture_default_str();
    app.add_option("--log-level", options.log_level, "How much is told on standard error")
        ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
        ->capture_default_str();
    app.add_option("--log-format", options.log_format,
                   "Lines for people, or objects of JSON with fields for session, robot and peer")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    app.add_flag("--insecure", options.insecure,
                 "Listen beyond this machine, although nothing guards a port: anybody there may send and read");
}

/// Sets the directory of the viewer. A directory that was named must have an index.html; the default one may be
/// missing.
Result<> settle_web(const std::string& named, ServerOptions& options) {
    options.web = named.empty() ? default_web() : std::filesystem::path(named);
    std::error_code ignored;
    if (named.empty() || std::filesystem::is_regular_file(options.web / "index.html", ignored)) return {};
    return Error{Errc::kNotFound, fmt::format("--web {}: there is no index.html in it; name the directory that the "
                                              "viewer was built into, or leave --web out",
                                              named)};
}

Result<> check_host_names(const std::vector<std::string>& names) {
    for (const auto& name : names) {
        const bool valid = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
            return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
        });
        if (valid) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("--http-host '{}' is not the name of a host; give it without scheme and port", name)};
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
    std::uint32_t id = 0;
    const char* end = raw.restore.data() + raw.restore.size();
    const auto [stopped, error] = std::from_chars(raw.restore.data(), end, id);
    if (error == std::errc{} && stopped == end && id > 0) {
        options.backup = id;
        return {};
    }
    return Error{Errc::kInvalidField,
                 fmt::format("--restore '{}' is no backup; give its number, or 'newest'", raw.restore)};
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
    options.weave_memory_bytes = static_cast<std::size_t>(raw.weave_memory_mib * 1024 * 1024);
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
    raw.weave_memory_mib = static_cast<double>(memory.weaves >> 20);

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
    std::uint16_t port = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data() + colon + 1, end, port);
    if (failed || error != std::errc{} || stopped != end) return malformed;
    return boost::asio::ip::tcp::endpoint(address, port);
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
    return {{{"--listen", options.listen, has_tokens, options.robot_tls, "--tokens or --robot-tls-cert guard it"},
             {"--http", options.http, has_tokens, options.http_tls, "--tokens or --http-tls-cert guard it"}}};
}

} // namespace

Result<> check_guarded(const ServerOptions& options) {
    if (options.insecure) return {};
    for (const auto& guard : guards_of(options)) {
        if (!guard.is_reached() || guard.has_tokens || guard.tls.is_given()) continue;
        return Error{
            Errc::kInvalidField,
            fmt::format(
                "{} {} can be reached from other machines and nothing guards it; {}; or listen on 127.0.0.1, or "
                "say --insecure if everybody there may send and read",
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
                fmt::format("{}: tokens come in without TLS, and whoever is on the way there can read them "
                            "and all else, and use them",
                            guard.flag));
        } else if (!guard.has_tokens) {
            const bool is_mutual = !guard.tls.client_ca.empty();
            warnings.push_back(fmt::format(
                "{}: no token is asked for, and whoever {} can send and read everything{}", guard.flag,
                is_mutual ? "shows a certificate that " + guard.tls.client_ca.string() + " signed" : "reaches it",
                guard.tls.is_given() ? ", though nobody on the way can" : ""));
        }
    }
    return warnings;
}

} // namespace scanloom::app
