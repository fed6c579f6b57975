#include "server/http/problem.hpp"

#include "common/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::http {
namespace {

std::string_view title_of(Errc code) {
    switch (code) {
    case Errc::kMalformed: return "Not understood";
    case Errc::kDamaged: return "Damaged in transmission";
    case Errc::kTooLarge: return "Too large";
    case Errc::kUnsupportedVersion: return "Unsupported version";
    case Errc::kInvalidField: return "Invalid value";
    case Errc::kNotFound: return "Not found";
    case Errc::kAlreadyExists: return "Exists already";
    case Errc::kConflict: return "Conflict with what exists";
    case Errc::kOutOfOrder: return "Out of order";
    case Errc::kCreditExceeded: return "Credit exceeded";
    case Errc::kTimeout: return "Took too long";
    case Errc::kReplaced: return "Replaced";
    case Errc::kGone: return "Deleted meanwhile";
    case Errc::kStoreFailed: return "The store failed";
    case Errc::kDataLoss: return "The store is damaged";
    case Errc::kShuttingDown: return "Not available now";
    case Errc::kUnauthorized: return "Not authorized";
    case Errc::kUnreachable: return "Unreachable";
    case Errc::kOverloaded: return "Too busy now";
    case Errc::kFull: return "Full";
    case Errc::kNoPath: return "No path";
    case Errc::kAmbiguous: return "Ambiguous position";
    case Errc::kUndetermined: return "Undetermined position";
    case Errc::kNothingMapped: return "Nothing mapped yet";
    case Errc::kInternal: return "The server failed";
    }
    return "Failed";
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

Status status_of(Errc code) noexcept {
    switch (code) {
    case Errc::kMalformed: return Status::bad_request;
    case Errc::kDamaged: return Status::bad_request;
    case Errc::kTooLarge: return Status::payload_too_large;
    case Errc::kUnsupportedVersion: return Status::bad_request;
    case Errc::kInvalidField: return Status::bad_request;
    case Errc::kNotFound: return Status::not_found;
    case Errc::kAlreadyExists: return Status::conflict;
    case Errc::kConflict: return Status::conflict;
    case Errc::kOutOfOrder: return Status::conflict;
    case Errc::kCreditExceeded: return Status::too_many_requests;
    case Errc::kTimeout: return Status::gateway_timeout;
    case Errc::kReplaced: return Status::conflict;
    case Errc::kGone: return Status::gone;
    case Errc::kStoreFailed: return Status::service_unavailable;
    case Errc::kDataLoss: return Status::internal_server_error;
    case Errc::kShuttingDown: return Status::service_unavailable;
    case Errc::kUnauthorized: return Status::unauthorized;
    case Errc::kUnreachable: return Status::bad_gateway;
    case Errc::kOverloaded: return Status::service_unavailable;
    case Errc::kFull: return Status::insufficient_storage;
    case Errc::kNoPath: return Status::conflict;
    case Errc::kAmbiguous: return Status::conflict;
    case Errc::kUndetermined: return Status::conflict;
    case Errc::kNothingMapped: return Status::conflict;
    case Errc::kInternal: return Status::internal_server_error;
    }
    return Status::internal_server_error;
}

Response problem(const Error& error, std::string_view path) {
    return problem_response(status_of(error.code), fmt::format("urn:scanloom:error:{}", name_of(error.code)),
                            title_of(error.code), error.message, path, {});
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
