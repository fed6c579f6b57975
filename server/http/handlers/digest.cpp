#include "server/http/handlers/digest.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/mapping/digest.hpp"

#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_digest(const MapsLookup& maps, const Call& call) {
    const auto found = maps.find_or_weave(call, {"layer"});
    if (!found) return found.error();
    const auto layer = layer_parameter(call.query);
    if (!layer) return layer.error();

    const auto& snapshot = found->snapshot;
    boost::json::object layers;
    for (const mapping::Layer each : mapping::kLayers) {
        const bool is_asked = !call.query.find("layer") || each == *layer;
        if (is_asked) layers[mapping::name_of(each)] = mapping::digest_of(*snapshot, each);
    }
    return ok(boost::json::object{{"revision", snapshot->revision}, {"layers", std::move(layers)}});
}

} // namespace scanloom::http
