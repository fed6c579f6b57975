#include "server/http/handlers/tile.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/tiles/tile.hpp"
#include "server/tiles/tile_version.hpp"

#include <fmt/format.h>

#include <optional>

namespace scanloom::http {
namespace {

/// Which version of a tile is asked for.
struct Version {
    std::optional<Revision> revision;
    std::optional<std::string_view> session_tag;
};

Result<Version> parse_version(const Query& query) {
    Version version{.revision = std::nullopt, .session_tag = query.find("id")};
    if (const auto text = query.find("v")) {
        version.revision = parse_integer<Revision>(*text);
        if (!version.revision) {
            return Error{Errc::kInvalidField, fmt::format("v is {}; a revision is needed", in_quotes(*text))};
        }
    }
    return version;
}

/// Whether the tile as it is now is the tile of that version for ever: nothing changed it since, and
/// that revision has been reached.
bool is_final(const Version& version, std::string_view tag, Revision tile, Revision now) {
    return version.revision && *version.revision >= tile && *version.revision <= now && version.session_tag == tag;
}

using Render = tiles::SharedBytes (*)(const mapping::Snapshot&, mapping::Layer, tiles::TileKey);

Result<Response> get_tile(const MapsLookup& maps, const Call& call, std::string_view content_type, Render render) {
    const auto version = parse_version(call.query);
    if (!version) return version.error();
    const auto key = tiles::parse_tile_key(call.arguments["z"], call.arguments["x"], call.arguments["y"]);
    if (!key) return key.error();
    const auto found = maps.find(call, {"v", "id"});
    if (!found) return found.error();
    const auto layer = find_layer(call.arguments["layer"]);
    if (!layer) return layer.error();

    const auto& [session, snapshot, tag] = *found;
    const Revision revision = tiles::tile_revision(*snapshot, *layer, *key);
    const auto etag = tiles::etag_of(tag, mapping::name_of(*layer), *key, revision);
    const auto kept = is_final(*version, tag, revision, snapshot->revision) ? kImmutable : kRevalidate;
    if (if_none_match_has(call.request.if_none_match, etag)) return not_modified(etag, kept);
    return ok(content_type, Body(render(*snapshot, *layer, *key))).set("ETag", etag).set("Cache-Control", kept);
}

} // namespace

Result<Response> get_tile_png(const MapsLookup& maps, const Call& call) {
    return get_tile(maps, call, "image/png", tiles::tile_png);
}

Result<Response> get_tile_bin(const MapsLookup& maps, const Call& call) {
    return get_tile(maps, call, "application/octet-stream", tiles::tile_codes);
}

} // namespace scanloom::http
