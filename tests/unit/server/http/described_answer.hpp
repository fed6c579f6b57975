#pragma once

#include "server/http/request.hpp"
#include "server/http/response.hpp"

#include <string>
#include <vector>

namespace scanloom::http {

/// What openapi.json does not say of this answer to this request: a status, a media type, a field of its JSON that is
/// missing, has another type or is not named there. Empty when it says all. Where a request finds no operation, the
/// answer has to be a problem.
[[nodiscard]] std::vector<std::string> undescribed(const Request& request, const Response& response);

} // namespace scanloom::http
