#include "server/sockets/listening_port.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>
#include <utility>

namespace scanloom::sockets {
namespace asio = boost::asio;
namespace {

Result<net::TlsContext> read(const TlsFiles& files) {
    return net::server_tls({files.certificate.string(), files.key.string()}, files.client_ca.string());
}

} // namespace

Result<std::shared_ptr<PortTls>> PortTls::open(TlsFiles files) {
    auto context = read(files);
    if (!context) return context.error();
    return std::shared_ptr<PortTls>(new PortTls(std::move(files), std::move(*context)));
}

Result<> PortTls::read_again() {
    auto context = read(files_);
    if (!context) return context.error();
    const std::lock_guard lock(mutex_);
    context_ = std::move(*context);
    return {};
}

net::TlsContext PortTls::in_force() const {
    const std::lock_guard lock(mutex_);
    return context_;
}

net::LinkStream stream_over(asio::ip::tcp::socket socket, const std::shared_ptr<const PortTls>& tls) {
    if (!tls) return net::LinkStream(std::move(socket));
    return {std::move(socket), *tls->in_force()};
}

asio::awaitable<void> accept_each(asio::ip::tcp::acceptor& acceptor, asio::io_context& io, std::string_view what,
                                  std::function<void(asio::ip::tcp::socket)> take) {
    asio::steady_timer pause(acceptor.get_executor());
    bool failed = false;
    while (acceptor.is_open()) {
        try {
            if (failed) {
                failed = false;
                pause.expires_after(std::chrono::milliseconds(100));
                co_await pause.async_wait(kAwaitTuple);
            }
            auto [error, socket] = co_await acceptor.async_accept(asio::make_strand(io), kAwaitTuple);
            if (!acceptor.is_open()) break;
            if (error) throw boost::system::system_error(error);
            take(std::move(socket));
        } catch (const std::exception& failure) {
            failed = true;
            spdlog::warn("{} could not be accepted: {}", what, failure.what());
        }
    }
}

} // namespace scanloom::sockets
