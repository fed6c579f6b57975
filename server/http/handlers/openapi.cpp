#include "server/http/handlers/openapi.hpp"

#include "server/http/openapi_text.hpp"

namespace scanloom::http {

Result<Response> get_openapi(const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    return ok(kJson, Body(std::string(kOpenapiText))).set("Cache-Control", kNotKept);
}

} // namespace scanloom::http
