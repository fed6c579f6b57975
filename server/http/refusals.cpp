#include "server/http/refusals.hpp"

#include "server/http/host.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/problem.hpp"

#include <boost/beast/http/error.hpp>
#include <fmt/format.h>

#include <string_view>

namespace scanloom::http {
namespace {

namespace beast = boost::beast;

/// Whether the unread bytes begin as a robot's frames do: with a length below 2^24, its highest byte first.
bool is_frame(const beast::flat_buffer& unread) {
    return unread.size() > 0 && *static_cast<const char*>(unread.data().data()) == '\0';
}

} // namespace

bool is_tls_hello(const beast::flat_buffer& unread) {
    const std::string_view bytes(static_cast<const char*>(unread.data().data()), unread.size());
    return bytes.starts_with("\x16\x03");
}

std::optional<Response> refusal_of(const beast::flat_buffer& unread, beast::error_code reason) {
    using beast::http::error;
    if (is_frame(unread)) {
        return problem(Status::bad_request,
                       "this is no HTTP but what robots send; they connect to the robot port (--listen)", "");
    }
    if (reason == error::header_limit || reason == error::buffer_overflow) {
        return problem(Status::request_header_fields_too_large, "the header is too large; send fewer or shorter fields",
                       "");
    }
    if (reason == error::body_limit) {
        return problem(Status::payload_too_large, "the body is too large; send less", "");
    }
    const bool is_protocol = reason.category() == beast::http::make_error_code(error::end_of_stream).category();
    if (!is_protocol || reason == error::end_of_stream || reason == error::partial_message) return std::nullopt;
    return problem(Status::bad_request, fmt::format("this is not HTTP/1.1: {}", reason.message()), "");
}

std::optional<Response> refusal_of(const Parser& parser, const Service& service, const std::string& peer) {
    using beast::http::field;
    const auto& message = parser.get();
    const auto path = [&] { return instance_of(view(message.target())); };
    if (message.count(field::transfer_encoding) > 0) {
        return problem(Status::length_required, "a Transfer-Encoding is not accepted; send a Content-Length", path());
    }
    if (message.count(field::host) > 1 || (message.count(field::host) == 0 && message.version() >= 11)) {
        return problem(Status::bad_request, "a request has exactly one Host field", path());
    }
    const bool is_large = parser.content_length().value_or(0) > service.config.body_bytes_max;
    if (is_large && lane_of(head_of(message)) != Lane::kImporting) {
        return problem(
            Status::payload_too_large,
            fmt::format("the body is too large; at most {} bytes are taken here", service.config.body_bytes_max),
            path());
    }
    const auto host = view(message[field::host]);
    if (service.check_host && !host.empty() && !is_known_host(host, service.config.host_names)) {
        service.answering.foreign_host(peer);
        return problem(Status::misdirected_request,
                       fmt::format("this server does not know itself as {}; ask it by its address", in_quotes(host)),
                       path());
    }
    return std::nullopt;
}

} // namespace scanloom::http
