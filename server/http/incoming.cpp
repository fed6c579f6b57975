#include "server/http/incoming.hpp"

#include "server/http/header_fields.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"

#include <boost/beast/http/error.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

#include <utility>

namespace scanloom::http {
namespace {

namespace beast = boost::beast;

/// Joins the values of all fields called `name` with commas.
std::string joined(const Incoming& message, beast::http::field name) {
    std::string values;
    const auto [begin, end] = message.equal_range(name);
    for (auto field = begin; field != end; ++field) {
        if (!values.empty()) values += ", ";
        values += view(field->value());
    }
    return values;
}

std::optional<WebSocketUpgrade> upgrade_of(const Incoming& message) {
    using beast::http::field;
    if (!beast::websocket::is_upgrade(message)) return std::nullopt;
    return WebSocketUpgrade{std::string(view(message[field::sec_websocket_version])),
                            std::string(view(message[field::sec_websocket_key])),
                            std::string(view(message[field::origin])), joined(message, field::sec_websocket_protocol)};
}

/// Splits a target in absolute form, "http://host/path?query": its authority replaces the Host field. Leaves all other
/// targets unchanged for parse_target() to check.
/// Source: RFC 9112, 3.2.2.
void split_absolute_form(Request& request) {
    if (request.target.starts_with('/')) return;
    const auto url = boost::urls::parse_absolute_uri(request.target);
    if (!url || url->encoded_host().empty() || url->has_userinfo()) return;
    if (url->scheme_id() != boost::urls::scheme::http && url->scheme_id() != boost::urls::scheme::https) return;
    request.host = url->encoded_host_and_port();
    const std::string resource(url->encoded_resource());
    request.target = resource.starts_with('/') ? resource : '/' + resource;
}

/// Returns whether the unread bytes begin like a robot's frame: with a length below 2^24, most significant byte first.
bool is_frame(const beast::flat_buffer& unread) {
    return unread.size() > 0 && *static_cast<const char*>(unread.data().data()) == '\0';
}

/// Returns the refusal of a request with unsupported or ambiguous fields.
std::optional<Response> refusal_of_fields(const Incoming& message, const std::string& path) {
    using beast::http::field;
    if (const auto coding = message[field::transfer_encoding]; message.count(field::transfer_encoding) > 0) {
        if (message.version() < 11 || message.count(field::content_length) > 0) {
            return problem(Status::bad_request, "a Transfer-Encoding needs HTTP/1.1, and no Content-Length", path);
        }
        if (message.count(field::transfer_encoding) > 1 || !beast::iequals(coding, "chunked")) {
            return problem(Status::not_implemented, "the only supported Transfer-Encoding is 'chunked'", path);
        }
    }
    const auto [first, last] = message.equal_range(field::content_encoding);
    for (auto coding = first; coding != last; ++coding) {
        if (coding->value().empty() || beast::iequals(coding->value(), "identity")) continue;
        return problem(Status::unsupported_media_type,
                       fmt::format("the Content-Encoding {} is not supported; send the body without it",
                                   in_quotes(view(coding->value()))),
                       path)
            .set("Accept-Encoding", "identity");
    }
    if (message.count(field::content_type) > 1) {
        return problem(Status::bad_request, "the Content-Type is given twice; give it once", path);
    }
    if (message.count(field::host) > 1 || (message.count(field::host) == 0 && message.version() >= 11)) {
        return problem(Status::bad_request, "a request has exactly one Host field", path);
    }
    return std::nullopt;
}

} // namespace

Request head_of(const Incoming& message) {
    Request request;
    request.method = view(message.method_string());
    request.target = view(message.target());
    request.host = view(message[beast::http::field::host]);
    split_absolute_form(request);
    request.content_type = view(message[beast::http::field::content_type]);
    request.authorization = view(message[beast::http::field::authorization]);
    request.cookie = view(message[beast::http::field::cookie]);
    request.origin = view(message[beast::http::field::origin]);
    request.upgrade = upgrade_of(message);
    return request;
}

void read_rest(Incoming& message, Request& request) {
    request.if_none_match = joined(message, beast::http::field::if_none_match);
    request.accept_encoding = joined(message, beast::http::field::accept_encoding);
    request.body = std::move(message.body());
}

bool is_tls_hello(const beast::flat_buffer& unread) {
    const std::string_view bytes(static_cast<const char*>(unread.data().data()), unread.size());
    return bytes.starts_with("\x16\x03");
}

std::optional<Response> refusal_of(const beast::flat_buffer& unread, beast::error_code reason) {
    using beast::http::error;
    if (is_frame(unread)) {
        return problem(Status::bad_request,
                       "this is the protocol of robots, not HTTP; connect robots to the robot port (--listen)", "");
    }
    if (reason == error::header_limit || reason == error::buffer_overflow) {
        return problem(Status::request_header_fields_too_large,
                       "the header, or a line of a chunked body, is too large; send fewer or shorter fields", "");
    }
    if (reason == error::body_limit) {
        return problem(Status::payload_too_large, "the body is too large; send less", "");
    }
    const bool is_protocol = reason.category() == beast::http::make_error_code(error::end_of_stream).category();
    if (!is_protocol || reason == error::end_of_stream || reason == error::partial_message) return std::nullopt;
    return problem(Status::bad_request, fmt::format("this is not HTTP/1.1: {}", reason.message()), "");
}

std::optional<Response> refusal_of(const Parser& parser, const Request& head, std::uint64_t bytes_max,
                                   const Service& service) {
    const auto path = instance_of(head.target);
    if (auto refusal = refusal_of_fields(parser.get(), path)) return refusal;
    if (parser.content_length().value_or(0) > bytes_max) {
        return problem(Status::payload_too_large,
                       fmt::format("the body is too large; at most {} bytes are taken here", bytes_max), path);
    }
    if (service.check_host && !head.is_forwarded && !head.host.empty() &&
        !is_known_host(head.host, service.config.host_names)) {
        service.api.services().authorizer.note({auth::Port::kHttp, auth::Reason::kForeignHost, head.peer, "", ""});
        return problem(Status::misdirected_request,
                       fmt::format("{} is not a name of this server; use its address", in_quotes(head.host)), path);
    }
    return std::nullopt;
}

std::uint64_t body_bytes_max(const Api::Routed* routed, const ServerConfig& config) {
    const bool is_form = routed != nullptr && routed->match.route.method == Method::kPostForm;
    return is_form ? config.import_bytes_max : config.body_bytes_max;
}

} // namespace scanloom::http
