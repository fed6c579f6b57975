#pragma once

#include "common/error/error.hpp"
#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <filesystem>
#include <memory>
#include <mutex>

namespace scanloom::sockets {

/// What the TLS of a port is made of, in PEM; no certificate: the port speaks plainly.
struct TlsFiles {
    std::filesystem::path certificate;
    std::filesystem::path key;
    std::filesystem::path client_ca; ///< who signed the certificates of clients; empty: they need none

    [[nodiscard]] bool is_given() const noexcept { return !certificate.empty(); }
};

/// The TLS of a listening port: its files as they were read last. Connections keep those with which they began.
/// Thread  any.
class PortTls {
public:
    /// Errors  those of net::server_tls().
    [[nodiscard]] static Result<std::shared_ptr<PortTls>> open(TlsFiles files);

    /// Errors  those of net::server_tls(); then what was read before stays in force.
    [[nodiscard]] Result<> read_again();

    [[nodiscard]] net::TlsContext in_force() const;
    [[nodiscard]] const TlsFiles& files() const noexcept { return files_; }

private:
    PortTls(TlsFiles files, net::TlsContext context) : files_(std::move(files)), context_(std::move(context)) {}

    const TlsFiles files_;
    mutable std::mutex mutex_; // guards the pointer
    net::TlsContext context_;
};

/// What a connection that was accepted is read from. `tls`: null where the port speaks plainly.
[[nodiscard]] net::LinkStream stream_over(boost::asio::ip::tcp::socket socket,
                                          const std::shared_ptr<const PortTls>& tls);

} // namespace scanloom::sockets
