#include "common/net/link_stream.hpp"

#include <boost/asio/ssl/host_name_verification.hpp>
#include <openssl/ssl.h>

namespace scanloom::net {

void LinkStream::expect_host(const std::string& host) {
    auto* tls = std::get_if<Tls>(&stream_);
    if (tls == nullptr) return;
    boost::system::error_code is_name;
    boost::asio::ip::make_address(host, is_name);
    if (is_name) SSL_set_tlsext_host_name(tls->native_handle(), host.c_str()); // addresses may not be sent (RFC 6066)
    tls->set_verify_callback(boost::asio::ssl::host_name_verification(host));
}

} // namespace scanloom::net
