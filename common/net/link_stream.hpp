#pragma once

#include <boost/asio/any_completion_handler.hpp>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/container/static_vector.hpp>

#include <string>
#include <utility>
#include <variant>

namespace scanloom::net {

/// A TCP connection with or without TLS, for robot frames, HTTP and Beast's WebSockets. Reading and writing are the
/// same in both cases.
///
/// Threads: as for Asio's sockets: one at a time; one read and one write may be outstanding together.
class LinkStream {
public:
    using Socket = boost::asio::ip::tcp::socket;
    using executor_type = Socket::executor_type;
    enum class Role { kServer, kClient };

    explicit LinkStream(Socket socket) : stream_(std::move(socket)) {}
    /// Creates an encrypted connection. `tls` may be destroyed afterwards: OpenSSL keeps what it needs.
    LinkStream(Socket socket, boost::asio::ssl::context& tls) : stream_(Tls(std::move(socket), tls)) {}

    [[nodiscard]] executor_type get_executor() { return socket().get_executor(); }
    [[nodiscard]] Socket& socket() {
        if (auto* tls = std::get_if<Tls>(&stream_)) return tls->next_layer();
        return std::get<Socket>(stream_);
    }
    [[nodiscard]] bool is_open() { return socket().is_open(); }
    [[nodiscard]] bool is_encrypted() const noexcept { return std::holds_alternative<Tls>(stream_); }
    void close() {
        boost::system::error_code ignored;
        socket().close(ignored);
    }

    /// Requires, on a client, that the server's certificate is valid for `host`, a DNS name or an IP address.
    /// Has no effect without TLS. Call it before async_handshake().
    void expect_host(const std::string& host);

    /// Returns, on a client whose handshake failed, OpenSSL's result of verifying the server's certificate
    /// (X509_V_ERR_...); 0 if the certificate is valid or the connection is not encrypted.
    [[nodiscard]] long verify_result() const;

    /// Performs the TLS handshake. Required before the first read or write; completes at once without TLS.
    template <class Token>
    auto async_handshake(Role role, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code)>(
            [this, role](auto handler) { start_handshake(role, std::move(handler)); }, token);
    }

    /// Shuts down the sending side without TLS's close_notify alert. The robot link does not need the alert: its frames
    /// say where it ends, so the peer detects a truncated connection.
    void shutdown_send() {
        boost::system::error_code ignored;
        socket().shutdown(Socket::shutdown_send, ignored);
    }

    /// Shuts down the sending side with TLS's close_notify alert, so that the peer can distinguish the end from a
    /// truncated connection, and waits for the peer's alert. Afterwards the caller may read what is left from socket().
    /// Without TLS it only shuts down the sending side.
    template <class Token>
    auto async_farewell(Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code)>(
            [this](auto handler) { start_farewell(std::move(handler)); }, token);
    }

    /// Writes what the socket accepts without waiting. With TLS it writes nothing, because the bytes would have to be
    /// encrypted first.
    /// @param buffers  the bytes to write
    /// @param failed   receives the error; would_block if the socket accepts nothing now
    /// @return number of bytes written
    /// Precondition: the socket is in non-blocking mode.
    template <class Buffers>
    std::size_t try_write(const Buffers& buffers, boost::system::error_code& failed) {
        return try_write_pieces(pieces_of<boost::asio::const_buffer>(buffers), failed);
    }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [this](auto handler, const auto& into) { start_read(into, std::move(handler)); }, token,
            pieces_of<boost::asio::mutable_buffer>(buffers));
    }

    template <class Buffers, class Token>
    auto async_write_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [this](auto handler, const auto& from) { start_write(from, std::move(handler)); }, token,
            pieces_of<boost::asio::const_buffer>(buffers));
    }

    /// Closes the connection in an orderly way after a WebSocket (Beast's async_teardown()).
    template <class Handler>
    void async_teardown(boost::beast::role_type role, Handler handler) {
        const executor_type executor = boost::asio::get_associated_executor(handler, get_executor());
        start_teardown(role, executor, std::move(handler));
    }

private:
    using Tls = boost::asio::ssl::stream<Socket>;
    using Done = boost::asio::any_completion_handler<void(boost::system::error_code)>;
    using Transferred = boost::asio::any_completion_handler<void(boost::system::error_code, std::size_t)>;

    /// The first non-empty buffers of a sequence, for the next read or write.
    template <class Buffer>
    using Pieces = boost::container::static_vector<Buffer, 16>;

    template <class Buffer, class Buffers>
    static Pieces<Buffer> pieces_of(const Buffers& buffers) {
        Pieces<Buffer> pieces;
        const auto end = boost::asio::buffer_sequence_end(buffers);
        for (auto at = boost::asio::buffer_sequence_begin(buffers); at != end && pieces.size() < pieces.capacity();
             ++at) {
            if (const Buffer piece(*at); piece.size() > 0) pieces.push_back(piece);
        }
        return pieces;
    }

    // Compiled once, in link_stream.cpp: Asio's TLS operations are large templates, and each handler type would get a
    // copy of its own.
    void start_handshake(Role role, Done done);
    void start_farewell(Done done);
    void start_teardown(boost::beast::role_type role, const executor_type& executor, Done done);
    void start_read(const Pieces<boost::asio::mutable_buffer>& into, Transferred done);
    void start_write(const Pieces<boost::asio::const_buffer>& from, Transferred done);
    std::size_t try_write_pieces(const Pieces<boost::asio::const_buffer>& from, boost::system::error_code& failed);

    std::variant<Socket, Tls> stream_;
};

// Functions that Beast's WebSocket finds for its stream type by argument-dependent lookup.

/// Closes the connection in an orderly way.
template <class Handler>
void async_teardown(boost::beast::role_type role, LinkStream& stream, Handler&& handler) {
    stream.async_teardown(role, std::forward<Handler>(handler));
}

/// Closes the connection at once, when a timeout of the WebSocket expires.
inline void beast_close_socket(LinkStream& stream) { stream.close(); }

} // namespace scanloom::net
