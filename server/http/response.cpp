#include "server/http/response.hpp"

#include "common/json/json_text.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>

namespace scanloom::http {
namespace {

/// Forbids loading and framing for every response that is not a page of the viewer.
constexpr std::string_view kNothingAllowed = "default-src 'none'; frame-ancestors 'none'";

/// Without includeSubDomains: whether other hosts of the domain support TLS is not known here.
constexpr std::string_view kSecureForAYear = "max-age=31536000";

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

Response created(const boost::json::value& json) {
    auto response = ok(json);
    response.status = Status::created;
    return response;
}

Response no_content() { return {.status = Status::no_content, .fields = {}, .body = {}}; }

Response not_modified(std::string_view etag, std::string_view cache_control) {
    Response response{.status = Status::not_modified, .fields = {}, .body = {}};
    response.set("ETag", etag).set("Cache-Control", cache_control);
    return response;
}

std::string date_of(std::time_t time) { return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT", fmt::gmtime(time)); }

std::string_view date_now() {
    thread_local std::time_t written = 0;
    thread_local std::string text;
    const std::time_t now = std::time(nullptr);
    if (now != written || text.empty()) text = date_of(written = now);
    return text;
}

Transfer transfer_of(const Response& response, const Manner& manner) noexcept {
    const Framing framing = response.stream == nullptr ? Framing::kLength
                            : manner.takes_chunks      ? Framing::kChunked
                                                       : Framing::kUntilClosed;
    const bool is_kept = manner.keep_alive && framing != Framing::kUntilClosed;
    return {framing, !is_kept              ? Persistence::kClose
                     : manner.takes_chunks ? Persistence::kKeepAlive
                                           : Persistence::kKeepAliveOfHttp10};
}

std::string head_text(const Response& response, Persistence persistence, std::string_view date, Framing framing,
                      bool is_secure) {
    constexpr std::size_t kUsualBytes = 512;
    const auto reason = boost::beast::http::obsolete_reason(response.status);
    std::string head;
    head.reserve(kUsualBytes);
    head.append("HTTP/1.1 ").append(fmt::format_int(static_cast<unsigned>(response.status)).c_str()).append(" ");
    head.append(reason.data(), reason.size()).append("\r\n");
    const auto add = [&](std::string_view name, std::string_view value) {
        head.append(name).append(": ").append(value).append("\r\n");
    };
    add("Date", date);
    for (const auto& [name, value] : response.fields) add(name, value);
    if (response.status != Status::no_content && response.status != Status::not_modified) {
        if (framing == Framing::kLength) add("Content-Length", fmt::format_int(response.body.bytes().size()).c_str());
        if (framing == Framing::kChunked) add("Transfer-Encoding", "chunked");
    }
    if (persistence == Persistence::kClose) add("Connection", "close");
    if (persistence == Persistence::kKeepAliveOfHttp10) add("Connection", "keep-alive");
    if (is_secure) add("Strict-Transport-Security", kSecureForAYear);
    add("X-Content-Type-Options", "nosniff");
    add("Referrer-Policy", "no-referrer");
    if (response.get("Content-Security-Policy").empty()) add("Content-Security-Policy", kNothingAllowed);
    return head.append("\r\n");
}

} // namespace scanloom::http
