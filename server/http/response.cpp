#include "server/http/response.hpp"

#include "server/http/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace scanloom::http {
namespace {

/// What is no page of ours may load nothing and be framed nowhere.
constexpr std::string_view kNothingAllowed = "default-src 'none'; frame-ancestors 'none'";

} // namespace

Response& Response::set(std::string_view field, std::string_view value) & {
    fields.emplace_back(field, value);
    return *this;
}

Response&& Response::set(std::string_view field, std::string_view value) && { return std::move(set(field, value)); }

std::string_view Response::get(std::string_view field) const {
    const auto found = std::ranges::find(fields, field, &std::pair<std::string_view, std::string>::first);
    return found == fields.end() ? std::string_view() : std::string_view(found->second);
}

Response ok(std::string_view content_type, Body body) {
    Response response;
    response.set("Content-Type", content_type);
    response.body = std::move(body);
    return response;
}

Response ok(const boost::json::value& json) { return ok(kJson, Body(json_text(json))).set("Cache-Control", kNotKept); }

Response not_modified(std::string_view etag, std::string_view cache_control) {
    Response response{.status = Status::not_modified, .fields = {}, .body = {}};
    response.set("ETag", etag).set("Cache-Control", cache_control);
    return response;
}

std::string head_text(const Response& response, bool keep_alive, std::string_view date, Framing framing) {
    const auto reason = boost::beast::http::obsolete_reason(response.status);
    std::string head = fmt::format("HTTP/1.1 {} {}\r\n", static_cast<unsigned>(response.status),
                                   std::string_view(reason.data(), reason.size()));
    const auto add = [&](std::string_view name, std::string_view value) {
        fmt::format_to(std::back_inserter(head), "{}: {}\r\n", name, value);
    };
    add("Date", date);
    for (const auto& [name, value] : response.fields) add(name, value);
    if (response.status != Status::no_content && response.status != Status::not_modified) {
        if (framing == Framing::kLength) add("Content-Length", fmt::to_string(response.body.bytes().size()));
        if (framing == Framing::kChunked) add("Transfer-Encoding", "chunked");
    }
    if (!keep_alive) add("Connection", "close");
    add("X-Content-Type-Options", "nosniff");
    add("Referrer-Policy", "no-referrer");
    if (response.get("Content-Security-Policy").empty()) add("Content-Security-Policy", kNothingAllowed);
    return head += "\r\n";
}

} // namespace scanloom::http
