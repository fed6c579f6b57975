#include "server/http/problem.hpp"

#include "common/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::http {
namespace {

/// How an error appears in a response.
struct Appearance {
    Status status;
    std::string_view title;
};

Appearance appearance_of(Errc code) noexcept {
    switch (code) {
    case Errc::kMalformed: return {Status::bad_request, "Not understood"};
    case Errc::kDamaged: return {Status::bad_request, "Damaged in transmission"};
    case Errc::kTooLarge: return {Status::payload_too_large, "Too large"};
    case Errc::kUnsupportedVersion: return {Status::bad_request, "Unsupported version"};
    case Errc::kInvalidField: return {Status::bad_request, "Invalid value"};
    case Errc::kNotFound: return {Status::not_found, "Not found"};
    case Errc::kAlreadyExists: return {Status::conflict, "Exists already"};
    case Errc::kConflict: return {Status::conflict, "Conflict with what exists"};
    case Errc::kOutOfOrder: return {Status::conflict, "Out of order"};
    case Errc::kCreditExceeded: return {Status::too_many_requests, "Credit exceeded"};
    case Errc::kTimeout: return {Status::gateway_timeout, "Took too long"};
    case Errc::kReplaced: return {Status::conflict, "Replaced"};
    case Errc::kGone: return {Status::gone, "Deleted meanwhile"};
    case Errc::kNotOwner: return {Status::service_unavailable, "On another server"};
    case Errc::kStoreFailed: return {Status::service_unavailable, "The store failed"};
    case Errc::kDataLoss: return {Status::internal_server_error, "The store is damaged"};
    case Errc::kShuttingDown: return {Status::service_unavailable, "Not available now"};
    case Errc::kUnauthorized: return {Status::unauthorized, "Not authorized"};
    case Errc::kUnreachable: return {Status::bad_gateway, "Unreachable"};
    case Errc::kOverloaded: return {Status::service_unavailable, "Too busy now"};
    case Errc::kFull: return {Status::insufficient_storage, "Full"};
    case Errc::kNoPath: return {Status::conflict, "No path"};
    case Errc::kAmbiguous: return {Status::conflict, "Ambiguous position"};
    case Errc::kUndetermined: return {Status::conflict, "Undetermined position"};
    case Errc::kNothingMapped: return {Status::conflict, "Nothing mapped yet"};
    case Errc::kInternal: return {Status::internal_server_error, "The server failed"};
    }
    return {Status::internal_server_error, "Failed"};
}

Response problem_response(Status status, std::string_view type, std::string_view title, std::string_view detail,
                          std::string_view path, const boost::json::object& extensions) {
    boost::json::object json{{"type", type},
                             {"title", title},
                             {"status", static_cast<unsigned>(status)},
                             {"detail", detail},
                             {"instance", path}};
    for (const auto& [name, value] : extensions) json[name] = value;
    auto response = ok("application/problem+json", Body(json_text(json))).set("Cache-Control", kNotKept);
    response.status = status;
    if (status == Status::service_unavailable) response.set("Retry-After", "1");
    return response;
}

} // namespace

Status status_of(Errc code) noexcept { return appearance_of(code).status; }

Response problem(const Error& error, std::string_view path) {
    const auto [status, title] = appearance_of(error.code);
    return problem_response(status, fmt::format("urn:scanloom:error:{}", name_of(error.code)), title, error.message,
                            path, {});
}

Response problem(Status status, std::string_view detail, std::string_view path, const boost::json::object& extensions) {
    const auto title = boost::beast::http::obsolete_reason(status);
    return problem_response(status, "about:blank", {title.data(), title.size()}, detail, path, extensions);
}

std::string instance_of(std::string_view target) {
    constexpr std::size_t kLength = 256;
    std::string path;
    for (const char c : target.substr(0, std::min(target.find('?'), kLength))) path += c > ' ' && c <= '~' ? c : '?';
    return path;
}

} // namespace scanloom::http
