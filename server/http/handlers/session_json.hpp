#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/session/session.hpp"

#include <boost/json/object.hpp>

#include <string>

namespace scanloom::http {

/// Everything about a session, as the API shows it.
[[nodiscard]] boost::json::object to_json(const session::Session& session);

/// What a new session is to be.
struct SessionRequest {
    std::string name;
    SessionOptions options;
};

/// Errors  kMalformed, kInvalidField, naming the field. Ranges are for the session to check.
[[nodiscard]] Result<SessionRequest> parse_session_request(std::string_view body);

} // namespace scanloom::http
