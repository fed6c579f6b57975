#pragma once

#include "common/error/error.hpp"
#include "server/http/target.hpp"
#include "server/session/session.hpp"
#include "server/session/weave_request.hpp"

#include <boost/json/object.hpp>

#include <span>
#include <string_view>

namespace scanloom::http {

/// What says that maps are to be woven anew: `until`, and every setting of a session. As parameters of an address or
/// members of a JSON object.
[[nodiscard]] std::span<const std::string_view> weave_parameters() noexcept;

/// Whether any of them is given.
[[nodiscard]] bool asks_for_weaving(const Query& query);

/// The session's own settings with those that are given in their place; following the session, or
///   until=912                     with entry 912 of its log (a revision)
///   until=976052857.5s            before the first scan that was taken later, by the robots' clocks, in seconds
///   until=2000-12-05T22:27:37Z    the same, for clocks that count from 1970
/// Errors  kInvalidField, naming the parameter; kConflict: the log has no such entry yet.
[[nodiscard]] Result<session::WeaveRequest> weave_request(const session::Session& session, const Query& query);
[[nodiscard]] Result<session::WeaveRequest> weave_request(const session::Session& session,
                                                          const boost::json::object& body);

} // namespace scanloom::http
