#pragma once

#include "common/limits/semaphore.hpp"
#include "server/live/live_config.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sockets/listening_port.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::http {

/// Limits for the clients: sizes, deadlines, counts. Requests above a limit on their number are answered 503.
struct ServerConfig {
    boost::asio::ip::tcp::endpoint endpoint; ///< port 0 picks a free one
    std::size_t connections_max = 1024;      ///< one more replaces the slowest one; see Server
    std::size_t connections_per_peer_max = 256;
    std::vector<boost::asio::ip::address> proxies; ///< exempt from connections_per_peer_max

    std::size_t changes_max = 16; ///< requests that create or delete sessions
    std::size_t weaves_max = 16;  ///< requests that wait for replay jobs
    std::size_t paths_max = 8;    ///< requests for trajectories, landmarks and point clouds; each may take a second
    std::size_t plans_max = 16;   ///< requests for frontiers, goals and planned paths

    std::uint32_t header_bytes_max = 8 * 1024;
    std::uint64_t body_bytes_max = 256 * 1024;                ///< a region of 4096 corners with all digits
    std::uint64_t import_bytes_max = std::uint64_t{80} << 20; ///< a map of 64 million cells and its YAML file
    std::size_t imports_max = 2;                              ///< concurrent imports

    live::LiveConfig live; ///< each viewer is one of the connections

    std::shared_ptr<const sockets::PortTls> tls = nullptr; ///< null: no TLS

    std::chrono::milliseconds handshake{10'000};  ///< for the TLS handshake, from the start of the connection
    std::chrono::milliseconds idle{60'000};       ///< between requests
    std::chrono::milliseconds header{10'000};     ///< from a request's first byte to the end of its header
    std::chrono::milliseconds body{30'000};       ///< for the body at first; each byte extends it by read_rate_min
    std::chrono::milliseconds body_pause{10'000}; ///< longest time without a byte of the body
    std::uint64_t read_rate_min = 256 * 1024;     ///< bytes per second by which a received body extends `body`
    std::chrono::milliseconds write{30'000};      ///< longest time without progress of the response
    std::uint64_t write_rate_min = 256 * 1024;    ///< bytes per second by which a whole response extends `write`
    std::chrono::milliseconds linger{2'000};      ///< for the peer to read the last response and disconnect
    std::chrono::milliseconds drain{3'000};       ///< after stop(), for current requests

    /// Host names of the server in addition to localhost and IP addresses. On a loopback address all other names are
    /// refused; on another address they are refused if this list is not empty.
    std::vector<std::string> host_names;

    /// Origins of pages of other sites that may open .../foxglove, such as "https://app.foxglove.dev".
    std::vector<std::string> viewer_origins;
};

class Api;

/// State that all connections of a server share.
struct Service {
    ServerConfig config;
    bool check_host = true;
    const Api& api;
    metrics::HttpCounters& counters;
    limits::KeyedSemaphore<store::SessionId> viewers; ///< connections of live viewers
};

} // namespace scanloom::http
