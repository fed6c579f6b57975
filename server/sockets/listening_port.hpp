#pragma once

#include "common/error/error.hpp"
#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string_view>

namespace scanloom::sockets {

/// The PEM files of a port's TLS. Without a certificate the port uses plain TCP.
struct TlsFiles {
    std::filesystem::path certificate;
    std::filesystem::path key;
    std::filesystem::path client_ca; ///< CA of client certificates; empty: clients need no certificate

    [[nodiscard]] bool is_given() const noexcept { return !certificate.empty(); }
};

/// The TLS settings of a listening port, as last read from its files. Open connections keep the settings they started
/// with.
/// Threads: any thread.
class PortTls {
public:
    /// Reads the files.
    /// Errors: those of net::server_tls().
    [[nodiscard]] static Result<std::shared_ptr<PortTls>> open(TlsFiles files);

    /// Reads the files again, for new connections.
    /// Errors: those of net::server_tls(); the previous settings then stay in force.
    [[nodiscard]] Result<> read_again();

    /// Returns the settings for new connections.
    [[nodiscard]] net::TlsContext in_force() const;
    [[nodiscard]] const TlsFiles& files() const noexcept { return files_; }

private:
    PortTls(TlsFiles files, net::TlsContext context) : files_(std::move(files)), context_(std::move(context)) {}

    const TlsFiles files_;
    mutable std::mutex mutex_; // guards the pointer
    net::TlsContext context_;
};

/// Returns the stream that an accepted connection is read from and written to.
/// @param tls  null if the port uses plain TCP
[[nodiscard]] net::LinkStream stream_over(boost::asio::ip::tcp::socket socket,
                                          const std::shared_ptr<const PortTls>& tls);

/// Accepts connections until the acceptor is closed. Passes each socket to `take`; the socket's executor is a new
/// strand.
///
/// A failure of accepting or of `take` is logged, loses one connection, and is followed by a pause of 100 ms in which
/// memory or descriptors may be released.
/// @param what  kind of peer, for the log ("a robot")
/// @param take  called on the acceptor's executor
/// Pre: acceptor, io and everything that `take` refers to outlive the coroutine.
/// Threads: spawn it on the acceptor's executor.
[[nodiscard]] boost::asio::awaitable<void> accept_each(boost::asio::ip::tcp::acceptor& acceptor,
                                                       boost::asio::io_context& io, std::string_view what,
                                                       std::function<void(boost::asio::ip::tcp::socket)> take);

} // namespace scanloom::sockets
