#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/session/roster.hpp"
#include "server/session/session.hpp"

#include <boost/json/object.hpp>

#include <string>
#include <string_view>

namespace scanloom::http {

/// Everything about a session, as the API shows it.
[[nodiscard]] boost::json::object to_json(const session::Session& session);
[[nodiscard]] boost::json::object to_json(const session::Listed& listed);

/// A session that takes no scans until it is read from the store again, in short: its name, its state and why.
[[nodiscard]] boost::json::object failed_json(std::string_view name, const Error& reason);

/// A session whose log is damaged, so that there is no more to show of it than that.
[[nodiscard]] boost::json::object damaged_json(std::string_view name, const Error& reason);

/// What a new session is to be.
struct SessionRequest {
    std::string name;
    SessionOptions options;
};

/// Errors  kMalformed, kInvalidField, naming the field. Ranges are for the session to check.
[[nodiscard]] Result<SessionRequest> parse_session_request(std::string_view body);

} // namespace scanloom::http
