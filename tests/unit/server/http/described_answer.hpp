#pragma once

#include "server/http/request.hpp"
#include "server/http/response.hpp"

#include <string>
#include <vector>

namespace scanloom::http {

/// Returns the differences between this response to this request and openapi.json: a status, a media type, a field of
/// its JSON that is missing, has another type or is not described. Empty if there are none. A request without an
/// operation must have a problem as its response.
[[nodiscard]] std::vector<std::string> undescribed(const Request& request, const Response& response);

} // namespace scanloom::http
