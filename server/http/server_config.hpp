#pragma once

#include "server/live/live_config.hpp"
#include "server/sockets/port_tls.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::http {

/// What bounds one peer: sizes, deadlines, numbers.
struct ServerConfig {
    boost::asio::ip::tcp::endpoint endpoint; ///< port 0 picks a free one
    std::size_t connections_max = 1024;      ///< for one more the slowest one goes; see Server
    std::size_t connections_per_peer_max = 256;
    std::vector<boost::asio::ip::address> proxies; ///< to which connections_per_peer_max does not apply

    std::size_t changes_max = 16; ///< requests that create or delete sessions; one more is answered 503
    std::size_t weaves_max = 16;  ///< requests that wait for maps to be woven; one more is answered 503
    std::size_t paths_max = 8;    ///< requests for paths, each of which may take a second; one more is answered 503
    std::size_t plans_max = 16;   ///< requests for frontiers, goals and ways; one more is answered 503

    std::uint32_t header_bytes_max = 8 * 1024;
    std::uint64_t body_bytes_max = 256 * 1024;                ///< a region of 4096 corners, every digit of them
    std::uint64_t import_bytes_max = std::uint64_t{80} << 20; ///< a map of 64 million cells, and what goes with it
    std::size_t imports_max = 2;                              ///< at once; one more is answered 503

    live::LiveConfig live; ///< each viewer is one of the connections

    std::shared_ptr<const sockets::PortTls> tls = nullptr; ///< none: requests come in plainly

    std::chrono::milliseconds handshake{10'000};  ///< of TLS, from the connection on
    std::chrono::milliseconds idle{60'000};       ///< between requests
    std::chrono::milliseconds header{10'000};     ///< from a request's first byte to the end of its header
    std::chrono::milliseconds body{30'000};       ///< for the body's beginning; each byte gives more, by read_rate_min
    std::chrono::milliseconds body_pause{10'000}; ///< in which some of the body must come
    std::uint64_t read_rate_min = 256 * 1024;     ///< bytes a second of a body, once its beginning is over
    std::chrono::milliseconds write{30'000};      ///< in which some of the answer must go out
    std::uint64_t write_rate_min = 256 * 1024;    ///< bytes a second that may be added to `write` for all of the answer
    std::chrono::milliseconds linger{2'000};      ///< for the peer to read the last answer and hang up
    std::chrono::milliseconds drain{3'000};       ///< after stop(), for requests under way

    /// Names besides localhost and addresses under which the server is asked. On a loopback address all
    /// other names are refused; elsewhere they are as soon as there is one here.
    std::vector<std::string> host_names;
};

} // namespace scanloom::http
