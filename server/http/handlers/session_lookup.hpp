#pragma once

#include "common/error/error.hpp"
#include "server/http/handlers/call.hpp"
#include "server/session/session_registry.hpp"

#include <memory>
#include <string>

namespace scanloom::http {

inline constexpr std::string_view kOccupancy = "occupancy";

/// The session of the call's path.
/// Errors  kNotFound; kStoreFailed: its log is damaged, and so it could not be recovered.
[[nodiscard]] Result<std::shared_ptr<session::Session>> find_session(const session::SessionRegistry& sessions,
                                                                     const Call& call);

/// What tells a session from every other one, also from one that had its name before, and from those of
/// a store that was here before: viewers keep what they were told is immutable. 16 hex digits.
[[nodiscard]] std::string session_tag(const session::SessionInfo& info);

/// Errors  kNotFound: no such layer.
[[nodiscard]] Result<> check_layer(std::string_view layer);

/// The layer parameter, if it is given.
/// Errors  kNotFound: no such layer.
[[nodiscard]] Result<> check_layer_parameter(const Query& query);

/// The since parameter, 0 when it is not given.
/// Errors  kInvalidField: not a revision.
[[nodiscard]] Result<Revision> since_parameter(const Query& query);

} // namespace scanloom::http
