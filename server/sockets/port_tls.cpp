#include "server/sockets/port_tls.hpp"

#include <utility>

namespace scanloom::sockets {
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

net::LinkStream stream_over(boost::asio::ip::tcp::socket socket, const std::shared_ptr<const PortTls>& tls) {
    if (!tls) return net::LinkStream(std::move(socket));
    return {std::move(socket), *tls->in_force()};
}

} // namespace scanloom::sockets
