#include "common/net/link_stream.hpp"

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
        SSL_set_tlsext_host_name(ssl, host.c_str()); // addresses may not be sent (RFC 6066)
        SSL_set1_host(ssl, host.c_str());
    } else {
        X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl), host.c_str());
    }
}

long LinkStream::verify_result() const {
    const auto* tls = std::get_if<Tls>(&stream_);
    return tls == nullptr ? 0 : SSL_get_verify_result(const_cast<Tls*>(tls)->native_handle());
}

} // namespace scanloom::net
