#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// POST .../weave: starts a replay job: maps of the same log with other settings, or up to `until`. Responds 202 while
/// the job runs, 200 if its maps exist already. Every URL of maps accepts `weave={id}` to return them.
[[nodiscard]] Result<Response> start_weave(const MapsLookup& maps, const Call& call);

/// GET .../weave: lists all replay jobs of the session, most recently used first.
[[nodiscard]] Result<Response> list_weaves(const MapsLookup& maps, const Call& call);

/// GET .../weave/{weave}: returns the progress of a replay job.
[[nodiscard]] Result<Response> get_weave(const MapsLookup& maps, const Call& call);

/// DELETE .../weave/{weave}: cancels and deletes a replay job.
[[nodiscard]] Result<Response> delete_weave(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
