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

/// A TCP connection, encrypted or not. Whoever reads and writes need not know which: it carries the frames of robots,
/// HTTP, and the WebSockets of Beast.
///
/// Thread  as of Asio's sockets: one at a time; one read and one write may be under way together.
class LinkStream {
public:
    using Socket = boost::asio::ip::tcp::socket;
    using executor_type = Socket::executor_type;
    enum class Role { kServer, kClient };

    explicit LinkStream(Socket socket) : stream_(std::move(socket)) {}
    /// OpenSSL keeps what it needs of `tls`, which may go.
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

    /// Of a client: the server has to prove that it is `host`. Pre: before async_handshake().
    void expect_host(const std::string& host);

    /// Of a client whose handshake failed: what was wrong with the server's certificate, as OpenSSL numbers it
    /// (X509_V_ERR_...); 0 where nothing was.
    [[nodiscard]] long verify_result() const;

    /// Must be done before anything is read or written. Completes at once where nothing is encrypted.
    template <class Token>
    auto async_handshake(Role role, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code)>(
            [this, role](auto handler) { start_handshake(role, std::move(handler)); }, token);
    }

    /// Nothing more is written. Without TLS's own goodbye: the frames of the link say where it ends, so that cutting it
    /// short fools nobody.
    void shutdown_send() {
        boost::system::error_code ignored;
        socket().shutdown(Socket::shutdown_send, ignored);
    }

    /// Nothing more is written, and the peer can tell that from a connection that was cut: TLS's own goodbye, which the
    /// peer should return. Then what is left may be read from the socket itself.
    template <class Token>
    auto async_farewell(Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code)>(
            [this](auto handler) { start_farewell(std::move(handler)); }, token);
    }

    /// What the socket takes at once, without waiting; nothing where it would have to be encrypted first.
    /// Pre     the socket does not block.
    /// Errors  would_block where it takes nothing now.
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

    /// Closes the connection in good order, as a WebSocket does (async_teardown() of Beast).
    template <class Handler>
    void async_teardown(boost::beast::role_type role, Handler handler) {
        const executor_type executor = boost::asio::get_associated_executor(handler, get_executor());
        start_teardown(role, executor, std::move(handler));
    }

private:
    using Tls = boost::asio::ssl::stream<Socket>;
    using Done = boost::asio::any_completion_handler<void(boost::system::error_code)>;
    using Transferred = boost::asio::any_completion_handler<void(boost::system::error_code, std::size_t)>;

    /// The first buffers of a sequence that are not empty: what is read or written next.
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

    // Compiled once, in link_stream.cpp: Asio's operations over TLS are many lines, and each handler would have its
    // own.
    void start_handshake(Role role, Done done);
    void start_farewell(Done done);
    void start_teardown(boost::beast::role_type role, const executor_type& executor, Done done);
    void start_read(const Pieces<boost::asio::mutable_buffer>& into, Transferred done);
    void start_write(const Pieces<boost::asio::const_buffer>& from, Transferred done);
    std::size_t try_write_pieces(const Pieces<boost::asio::const_buffer>& from, boost::system::error_code& failed);

    std::variant<Socket, Tls> stream_;
};

} // namespace scanloom::net
