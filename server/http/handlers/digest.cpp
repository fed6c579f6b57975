#include "server/http/handlers/digest.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/mapping/digest.hpp"

#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_digest(const session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({"layer"}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    if (auto known = check_layer_parameter(call.query); !known) return known.error();

    const auto snapshot = (*session)->snapshot();
    return ok(
        boost::json::object{{"revision", snapshot->revision},
                            {"layers", boost::json::object{{kOccupancy, mapping::digest_of(snapshot->occupancy)}}}});
}

} // namespace scanloom::http
