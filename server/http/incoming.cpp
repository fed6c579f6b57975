#include "server/http/incoming.hpp"

#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

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

} // namespace

Request head_of(const Incoming& message) {
    Request request;
    request.method = view(message.method_string());
    request.target = view(message.target());
    request.host = view(message[beast::http::field::host]);
    request.content_type = view(message[beast::http::field::content_type]);
    request.authorization = view(message[beast::http::field::authorization]);
    request.cookie = view(message[beast::http::field::cookie]);
    request.origin = view(message[beast::http::field::origin]);
    request.upgrade = upgrade_of(message);
    return request;
}

Request request_of(Incoming& message) {
    Request request = head_of(message);
    const auto [begin, end] = message.equal_range(beast::http::field::if_none_match);
    for (auto field = begin; field != end; ++field) {
        if (!request.if_none_match.empty()) request.if_none_match += ", ";
        request.if_none_match += view(field->value());
    }
    request.body = std::move(message.body());
    return request;
}

} // namespace scanloom::http
