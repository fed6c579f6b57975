#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../digest?layer: a hash over the canonical cells of each layer; equal digests are equal maps.
[[nodiscard]] Result<Response> get_digest(const session::SessionRegistry& sessions, const Call& call);

} // namespace scanloom::http
