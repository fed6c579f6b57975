#include "common/net/link_stream.hpp"

#include <boost/asio/append.hpp>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

namespace scanloom::net {

void LinkStream::expect_host(const std::string& host) {
    auto* tls = std::get_if<Tls>(&stream_);
    if (tls == nullptr) return;
    boost::system::error_code is_name;
    boost::asio::ip::make_address(host, is_name);
    SSL* ssl = tls->native_handle();
    if (is_name) {
        SSL_set_tlsext_host_name(ssl, host.c_str()); // RFC 6066 forbids sending addresses
        SSL_set1_host(ssl, host.c_str());
    } else {
        X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl), host.c_str());
    }
}

void LinkStream::start_handshake(Role role, Done done) {
    if (auto* tls = std::get_if<Tls>(&stream_)) {
        tls->async_handshake(role == Role::kServer ? Tls::server : Tls::client, std::move(done));
    } else {
        boost::asio::post(get_executor(), boost::asio::append(std::move(done), boost::system::error_code()));
    }
}

void LinkStream::start_farewell(Done done) {
    if (auto* tls = std::get_if<Tls>(&stream_)) {
        tls->async_shutdown(std::move(done));
    } else {
        shutdown_send();
        boost::asio::post(get_executor(), boost::asio::append(std::move(done), boost::system::error_code()));
    }
}

void LinkStream::start_read(const Pieces<boost::asio::mutable_buffer>& into, Transferred done) {
    std::visit([&](auto& stream) { stream.async_read_some(into, std::move(done)); }, stream_);
}

void LinkStream::start_write(const Pieces<boost::asio::const_buffer>& from, Transferred done) {
    std::visit([&](auto& stream) { stream.async_write_some(from, std::move(done)); }, stream_);
}

void LinkStream::start_teardown(boost::beast::role_type role, const executor_type& executor, Done done) {
    using boost::beast::websocket::async_teardown;
    // Beast posts the handler, which the executor of an any_completion_handler cannot do.
    auto on_executor = boost::asio::bind_executor(executor, std::move(done));
    std::visit([&](auto& stream) { async_teardown(role, stream, std::move(on_executor)); }, stream_);
}

std::size_t LinkStream::try_write_pieces(const Pieces<boost::asio::const_buffer>& from,
                                         boost::system::error_code& failed) {
    failed = {};
    auto* plain = std::get_if<Socket>(&stream_);
    return plain == nullptr ? 0 : plain->write_some(from, failed);
}

long LinkStream::verify_result() const {
    const auto* tls = std::get_if<Tls>(&stream_);
    return tls == nullptr ? 0 : SSL_get_verify_result(const_cast<Tls*>(tls)->native_handle());
}

} // namespace scanloom::net
