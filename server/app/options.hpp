#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "server/sockets/listening_port.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace scanloom::app {

/// What the program does after it has started.
enum class Task {
    kServe,
    kCheck,     ///< reads all of a store that no server has open
    kCheckMaps, ///< as kCheck, and computes the maps of every log again and compares them
    kRepair,    ///< writes the intact parts of a store to a new store
    kRestore,   ///< writes the store of a backup to an empty directory
    kCopy,      ///< copies a store to a new one, of the same or of another kind
};

/// The settings of scanloom-server, from flags, SCANLOOM_* variables and a TOML file, in order of precedence.
struct ServerOptions {
    Task task = Task::kServe;
    boost::asio::ip::tcp::endpoint listen{boost::asio::ip::address_v4::loopback(), 7447}; ///< for robots
    boost::asio::ip::tcp::endpoint http{boost::asio::ip::address_v4::loopback(), 8080};   ///< for browsers, API clients
    std::filesystem::path store;                  ///< or the address of a database, postgresql://...
    bool allow_unreplicated = false;              ///< accept a database without a synchronous standby
    std::optional<std::uint64_t> store_bytes_max; ///< of a store in a database; nullopt: no limit
    std::string
        node; ///< its name among the servers of one database; empty: that of the machine and the port for robots
    std::filesystem::path repaired;      ///< the store that --repair creates
    std::filesystem::path copied;        ///< the store that --copy creates
    std::filesystem::path backups;       ///< directory of the backups; empty: backups are disabled
    std::size_t backups_kept = 7;        ///< number of backups kept, the newest ones
    std::optional<std::uint32_t> backup; ///< id of the backup to restore; nullopt: the newest
    std::filesystem::path web;           ///< the viewer's files
    std::filesystem::path tokens;        ///< file of the tokens; empty: every client may do everything
    sockets::TlsFiles robot_tls;
    sockets::TlsFiles http_tls;
    std::vector<std::string> http_hosts; ///< accepted host names of the HTTP port, in addition to localhost
    std::vector<std::string> viewer_origins{"https://app.foxglove.dev"}; ///< pages that may open .../foxglove
    std::vector<boost::asio::ip::address> http_proxies; ///< addresses without the per-address connection limit
    std::size_t threads = 1;                            ///< that integrate scans; the same number answers requests
    std::size_t tile_cache_bytes = std::size_t{64} << 20;
    std::uint64_t disk_reserve_bytes = std::uint64_t{256} << 20;
    std::size_t map_memory_bytes = std::size_t{1} << 30;    ///< for the maps of all sessions in memory
    std::size_t replay_memory_bytes = std::size_t{1} << 29; ///< for the maps of all replay jobs
    std::chrono::milliseconds idle_after{600'000};          ///< an unused session is evicted after this time
    std::string log_level = "info";
    std::string log_format = "text"; ///< or "json"
    bool insecure = false;           ///< allow to listen beyond loopback without tokens or TLS
};

/// Reads and validates the settings.
/// @return the settings, or what to print before the program exits: help, the version, a usage error, a new token
[[nodiscard]] std::variant<ServerOptions, Leave> read_options(int argc, const char* const* argv);

/// Parses an address and port, such as "127.0.0.1:8080" or "[::1]:0".
/// Errors: kInvalidField if the text has another form.
[[nodiscard]] Result<boost::asio::ip::tcp::endpoint> parse_endpoint(const std::string& text);

} // namespace scanloom::app
