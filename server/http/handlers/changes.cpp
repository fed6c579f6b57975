#include "server/http/handlers/changes.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/tiles/changes.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_changes(const session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({"layer", "since"}); !known) return known.error();
    const auto since = since_parameter(call.query);
    if (!since) return since.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    const auto layer = layer_parameter(call.query);
    if (!layer) return layer.error();

    const auto snapshot = (*session)->snapshot();
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
