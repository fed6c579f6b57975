#include "server/http/handlers/changes.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/tiles/tile.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_changes(const MapsLookup& maps, const Call& call) {
    const auto since = since_parameter(call.query);
    if (!since) return since.error();
    const auto found = maps.find(call, {"layer", "since"});
    if (!found) return found.error();
    const auto layer = layer_parameter(call.query);
    if (!layer) return layer.error();

    const auto& snapshot = found->snapshot;
    boost::json::array changed;
    for (const auto& [key, revision] : tiles::changed_tiles(*snapshot, *layer, since_in(*snapshot, *since))) {
        changed.push_back(boost::json::object{{"z", key.zoom}, {"x", key.x}, {"y", key.y}, {"revision", revision}});
    }
    return ok(boost::json::object{{"layer", mapping::name_of(*layer)},
                                  {"since", *since},
                                  {"reset", since_in(*snapshot, *since) != *since},
                                  {"revision", snapshot->revision},
                                  {"tiles", std::move(changed)}});
}

} // namespace scanloom::http
