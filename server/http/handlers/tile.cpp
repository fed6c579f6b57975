#include "server/http/handlers/tile.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/tiles/tile.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

constexpr Revision kNewest = std::numeric_limits<Revision>::max();

/// The requested version of a tile.
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

/// Returns whether the current tile will always be the tile of that version: it has not changed since, and that
/// revision has been reached.
bool is_final(const Version& version, std::string_view tag, Revision tile, Revision now) {
    return version.revision && *version.revision >= tile && *version.revision <= now && version.session_tag == tag;
}

/// The parsed parameters of the request.
struct TileParameters {
    Version version;
    tiles::TileKey key;
    mapping::Layer layer;
};

Result<TileParameters> parse(const Call& call) {
    const auto version = parse_version(call.query);
    if (!version) return version.error();
    const auto key = tiles::parse_tile_key(call.arguments["z"], call.arguments["x"], call.arguments["y"]);
    if (!key) return key.error();
    const auto layer = find_layer(call.arguments["layer"]);
    if (!layer) return layer.error();
    return TileParameters{*version, *key, *layer};
}

/// A requested tile before rendering.
struct WantedTile {
    Maps maps;
    tiles::TilePlace place;
    Revision revision; ///< of the tile
    std::string etag;
    std::string_view kept; ///< Cache-Control
};

tiles::TilePlace place_of(const TileParameters& asked, const Maps& maps, tiles::TileFormat format) {
    return {maps.tag, asked.layer, asked.key, format};
}

WantedTile wanted_tile(const TileParameters& asked, Maps maps, tiles::TileFormat format) {
    const Revision revision = tiles::tile_revision(*maps.snapshot, asked.layer, asked.key);
    auto etag = tiles::etag_of(maps.tag, mapping::name_of(asked.layer), asked.key, revision);
    const bool is_kept = is_final(asked.version, maps.tag, revision, maps.snapshot->revision);
    auto place = place_of(asked, maps, format);
    return WantedTile{std::move(maps), std::move(place), revision, std::move(etag), is_kept ? kImmutable : kRevalidate};
}

bool is_known(const WantedTile& wanted, const Call& call) {
    return if_none_match_has(call.request.if_none_match, wanted.etag);
}

tiles::TileSource source_of(const Maps& maps) { return {*maps.snapshot, maps.origin}; }

Response answer_of(const WantedTile& wanted, tiles::SharedBytes bytes) {
    const bool is_png = wanted.place.format == tiles::TileFormat::kPng;
    return ok(is_png ? "image/png" : "application/octet-stream", Body(std::move(bytes)))
        .set("ETag", wanted.etag)
        .set("Cache-Control", wanted.kept);
}

} // namespace

Result<Response> get_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call, tiles::TileFormat format) {
    const auto asked = parse(call);
    if (!asked) return asked.error();
    auto found = maps.find(call, {"v", "id"});
    if (!found) return found.error();
    const WantedTile wanted = wanted_tile(*asked, std::move(*found), format);
    if (is_known(wanted, call)) return not_modified(wanted.etag, wanted.kept);
    return answer_of(wanted, maker.make(source_of(wanted.maps), wanted.place, wanted.revision));
}

Result<Outlook> look_at_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call,
                             tiles::TileFormat format) {
    const auto asked = parse(call);
    if (!asked) return asked.error();
    auto found = maps.find_at_once(call, {"v", "id"});
    if (!found) return found.error();
    const auto lane_of = [&](const Maps& tile_of, const tiles::TilePlace& place, Revision revision) {
        return maker.is_quick(tile_of.origin, place, revision) ? Lane::kServing : Lane::kSurvey;
    };
    if (!found->snapshot) return lane_of(*found, place_of(*asked, *found, format), kNewest);
    const WantedTile wanted = wanted_tile(*asked, std::move(*found), format);
    if (is_known(wanted, call)) return not_modified(wanted.etag, wanted.kept);
    if (auto bytes = maker.find(wanted.place, wanted.revision)) return answer_of(wanted, std::move(bytes));
    return lane_of(wanted.maps, wanted.place, wanted.revision);
}

} // namespace scanloom::http
