#include "server/http/incoming.hpp"

#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

#include <utility>

namespace scanloom::http {
namespace {

namespace beast = boost::beast;

std::optional<WebSocketUpgrade> upgrade_of(const Incoming& message) {
    using beast::http::field;
    if (!beast::websocket::is_upgrade(message)) return std::nullopt;
    return WebSocketUpgrade{std::string(view(message[field::sec_websocket_version])),
                            std::string(view(message[field::sec_websocket_key])),
                            std::string(view(message[field::origin]))};
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

} // namespace scanloom::http
