#include "server/http/handlers/digest.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/mapping/digest.hpp"

#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_digest(const session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({"layer"}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    const auto layer = layer_parameter(call.query);
    if (!layer) return layer.error();

    const auto snapshot = (*session)->snapshot();
    boost::json::object layers;
    for (const mapping::Layer each : mapping::kLayers) {
        const bool is_asked = !call.query.find("layer") || each == *layer;
        if (is_asked) layers[mapping::name_of(each)] = mapping::digest_of(*snapshot, each);
    }
    return ok(boost::json::object{{"revision", snapshot->revision}, {"layers", std::move(layers)}});
}

} // namespace scanloom::http
