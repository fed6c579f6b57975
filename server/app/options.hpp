#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "server/sockets/port_tls.hpp"

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

/// What the program is started for.
enum class Task {
    kServe,
    kCheck,     ///< reads all of a store that no server has open
    kCheckMaps, ///< and weaves every log anew
    kRepair,    ///< writes what is intact of a store into another
    kRestore,   ///< writes a store as a backup has it
};

/// What scanloom-server can be told, by flag, SCANLOOM_* variable or TOML file, in that order.
struct ServerOptions {
    Task task = Task::kServe;
    boost::asio::ip::tcp::endpoint listen; ///< robots
    boost::asio::ip::tcp::endpoint http;   ///< people and programs
    std::filesystem::path store;
    std::filesystem::path repaired;      ///< the store that --repair makes
    std::filesystem::path backups;       ///< where backups are made; empty: nowhere
    std::size_t backups_kept = 7;        ///< the newest
    std::optional<std::uint32_t> backup; ///< to restore; nothing: the newest
    std::filesystem::path web;           ///< the viewer's files
    std::filesystem::path tokens;        ///< who may do what; empty: everybody may do everything
    sockets::TlsFiles robot_tls;
    sockets::TlsFiles http_tls;
    std::vector<std::string> http_hosts;                ///< names by which the HTTP port is asked, besides localhost
    std::vector<boost::asio::ip::address> http_proxies; ///< not bounded in connections as other addresses are
    std::size_t threads = 1;                            ///< that weave, and as many that answer requests
    std::size_t tile_cache_bytes = std::size_t{64} << 20;
    std::uint64_t disk_reserve_bytes = std::uint64_t{256} << 20;
    std::size_t map_memory_bytes = std::size_t{1} << 30;   ///< of the maps of all sessions that are in memory
    std::size_t weave_memory_bytes = std::size_t{1} << 29; ///< of the maps woven anew from all logs
    std::chrono::milliseconds idle_after{600'000};         ///< without use, a session leaves memory
    std::string log_level = "info";
    std::string log_format = "text"; ///< or "json"
    bool insecure = false;           ///< listen beyond loopback without a guard
};

[[nodiscard]] std::variant<ServerOptions, Leave> read_options(int argc, const char* const* argv);

/// "127.0.0.1:8080", "[::1]:0". Errors: kInvalidField.
[[nodiscard]] Result<boost::asio::ip::tcp::endpoint> parse_endpoint(const std::string& text);

/// Errors  kInvalidField: an endpoint beyond loopback that nothing guards, without --insecure.
[[nodiscard]] Result<> check_guarded(const ServerOptions& options);

/// What others can do all the same, a sentence each: for whoever starts the server.
[[nodiscard]] std::vector<std::string> guard_warnings(const ServerOptions& options);

} // namespace scanloom::app
