#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "core/mapping/map_config.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_cache.hpp"
#include "server/tiles/map_image.hpp"

#include <boost/json/object.hpp>

#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns the corners of a rectangle, in metres.
[[nodiscard]] boost::json::object to_json(const tiles::Extent& extent);

/// Returns all properties of a session, as the API shows them.
[[nodiscard]] boost::json::object to_json(const sessions::Session& session);
/// @param store_failure  why the store accepts no changes; nullopt if it does. Sessions notice it only when
///                       a robot sends
[[nodiscard]] boost::json::object to_json(const sessions::ListedSession& listed,
                                          std::optional<std::string> store_failure);

/// Returns a short description of a session that accepts no scans until it is loaded again from the store: its name,
/// its state and the reason.
[[nodiscard]] boost::json::object failed_json(std::string_view name, const Error& reason);

/// Returns a short description of a session whose log is damaged, so that its other properties are not available.
[[nodiscard]] boost::json::object damaged_json(std::string_view name, const Error& reason);

/// The parameters of a new session.
struct SessionRequest {
    std::string name;
    SessionOptions options;
    bool is_localize_only = false; ///< whether it begins in this mode
};

/// Errors: kMalformed or kInvalidField, naming the field. The session checks the ranges.
[[nodiscard]] Result<SessionRequest> parse_session_request(std::string_view body);

/// Returns every setting by its name.
[[nodiscard]] boost::json::object to_json(const mapping::MapConfig& config);

/// Sets the options that `object` has members for and keeps the others. resolve() checks the ranges.
/// Errors: kInvalidField, naming the member, if a value has another type.
[[nodiscard]] Result<> read_options(const boost::json::object& object, SessionOptions& options);

} // namespace scanloom::http
