#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

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
            [this](auto handler, Role as) {
                if (auto* tls = std::get_if<Tls>(&stream_)) {
                    tls->async_handshake(as == Role::kServer ? Tls::server : Tls::client, std::move(handler));
                } else {
                    boost::asio::post(get_executor(), [handler = std::move(handler)]() mutable {
                        std::move(handler)(boost::system::error_code());
                    });
                }
            },
            token, role);
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
            [this](auto handler) {
                if (auto* tls = std::get_if<Tls>(&stream_)) {
                    tls->async_shutdown(std::move(handler));
                } else {
                    shutdown_send();
                    boost::asio::post(get_executor(), [handler = std::move(handler)]() mutable {
                        std::move(handler)(boost::system::error_code());
                    });
                }
            },
            token);
    }

    /// What the socket takes at once, without waiting; nothing where it would have to be encrypted first.
    /// Pre     the socket does not block.
    /// Errors  would_block where it takes nothing now.
    template <class Buffers>
    std::size_t try_write(const Buffers& buffers, boost::system::error_code& failed) {
        failed = {};
        auto* plain = std::get_if<Socket>(&stream_);
        return plain == nullptr ? 0 : plain->write_some(buffers, failed);
    }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [this](auto handler, const Buffers& into) {
                std::visit([&](auto& stream) { stream.async_read_some(into, std::move(handler)); }, stream_);
            },
            token, buffers);
    }

    template <class Buffers, class Token>
    auto async_write_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [this](auto handler, const Buffers& from) {
                std::visit([&](auto& stream) { stream.async_write_some(from, std::move(handler)); }, stream_);
            },
            token, buffers);
    }

    /// Calls `use` with the socket, or with Asio's ssl::stream over it: for libraries that know both.
    template <class Use>
    void with_carrier(Use&& use) {
        std::visit(std::forward<Use>(use), stream_);
    }

private:
    using Tls = boost::asio::ssl::stream<Socket>;

    std::variant<Socket, Tls> stream_;
};

} // namespace scanloom::net
