#include "server/http/handlers/handlers.hpp"

#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/text.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/tile.hpp"
#include "server/tiles/tile_key.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace scanloom::http {
namespace {

constexpr Revision kNewest = std::numeric_limits<Revision>::max();

/// The requested version of a tile.
struct Version {
    std::optional<Revision> revision;
    std::optional<std::string_view> session_tag;
};

/// Returns whether the current tile will always be the tile of that version: it has not changed since, and that
/// revision has been reached.
bool is_immutable(const Version& version, std::string_view tag, Revision tile, Revision now) {
    return version.revision && *version.revision >= tile && *version.revision <= now && version.session_tag == tag;
}

/// The parsed parameters of the request.
struct TileParameters {
    Version version;
    tiles::TileKey key;
    mapping::Layer layer;
};

Result<TileParameters> parse(const Context& context) {
    const auto revision =
        parameter(context.query, "v", std::optional<Revision>(), parse_integer<Revision>, "a revision is needed");
    if (!revision) return revision.error();
    const auto key = tiles::parse_tile_key(context.arguments["z"], context.arguments["x"], context.arguments["y"]);
    if (!key) return key.error();
    const auto layer = find_layer(context.arguments["layer"]);
    if (!layer) return layer.error();
    return TileParameters{{*revision, context.query.find("id")}, *key, *layer};
}

/// A requested tile before rendering.
struct WantedTile {
    Maps maps;
    tiles::TilePlace place;
    Revision revision; ///< of the tile
    std::string etag;
    std::string_view cache_control;
};

tiles::TilePlace place_of(const TileParameters& asked, const Maps& maps, tiles::TileFormat format) {
    return {maps.tag, asked.layer, asked.key, format};
}

WantedTile wanted_tile(const TileParameters& asked, Maps maps, tiles::TileFormat format) {
    const Revision revision = tiles::tile_revision(*maps.snapshot, asked.layer, asked.key);
    auto etag = tiles::etag_of(maps.tag, mapping::name_of(asked.layer), asked.key, revision);
    const bool is_kept = is_immutable(asked.version, maps.tag, revision, maps.snapshot->revision);
    auto place = place_of(asked, maps, format);
    return WantedTile{std::move(maps), std::move(place), revision, std::move(etag), is_kept ? kImmutable : kRevalidate};
}

bool is_known(const WantedTile& wanted, const Context& context) {
    return if_none_match_has(context.request.if_none_match, wanted.etag);
}

tiles::TileSource source_of(const Maps& maps) { return {*maps.snapshot, maps.origin}; }

Response answer_of(const WantedTile& wanted, tiles::SharedBytes bytes) {
    const bool is_png = wanted.place.format == tiles::TileFormat::kPng;
    return ok(is_png ? "image/png" : "application/octet-stream", Body(std::move(bytes)))
        .set("ETag", wanted.etag)
        .set("Cache-Control", wanted.cache_control);
}

/// Does what takes microseconds and does not wait.
/// @return a refusal, "not modified", or a tile that exists; else the class of the work that makes the tile
Result<std::variant<Response, WorkClass>> find_tile(const Context& context, const TileParameters& asked,
                                                    tiles::TileFormat format) {
    auto found = find_maps(context, Waiting::kNotAllowed);
    if (!found) return found.error();
    auto& tiles = context.services.tiles;
    const auto work_for = [&](const Maps& maps, const tiles::TilePlace& place, Revision revision) {
        return tiles.is_quick(maps.origin, place, revision) ? WorkClass::kQueries : WorkClass::kWholeMaps;
    };
    if (!found->snapshot) return {work_for(*found, place_of(asked, *found, format), kNewest)};
    const WantedTile wanted = wanted_tile(asked, std::move(*found), format);
    if (is_known(wanted, context)) return {not_modified(wanted.etag, wanted.cache_control)};
    if (auto bytes = tiles.find(wanted.place, wanted.revision)) return {answer_of(wanted, std::move(bytes))};
    return {work_for(wanted.maps, wanted.place, wanted.revision)};
}

/// Makes the tile from the newest maps, as others may have made it since find_tile().
Result<Response> make_tile(const Context& context, const TileParameters& asked, tiles::TileFormat format) {
    auto found = find_maps(context);
    if (!found) return found.error();
    const WantedTile wanted = wanted_tile(asked, std::move(*found), format);
    if (is_known(wanted, context)) return not_modified(wanted.etag, wanted.cache_control);
    return answer_of(wanted, context.services.tiles.make(source_of(wanted.maps), wanted.place, wanted.revision));
}

boost::asio::awaitable<Result<Response>> get_tile(Context& context, tiles::TileFormat format) {
    const auto asked = parse(context);
    if (!asked) co_return asked.error();
    auto found = find_tile(context, *asked, format);
    if (!found) co_return found.error();
    if (auto* response = std::get_if<Response>(&*found)) co_return std::move(*response);
    co_await context.run_on(std::get<WorkClass>(*found));
    co_return make_tile(context, *asked, format);
}

} // namespace

boost::asio::awaitable<Result<Response>> get_tile_png(Context& context) {
    return get_tile(context, tiles::TileFormat::kPng);
}

boost::asio::awaitable<Result<Response>> get_tile_bin(Context& context) {
    return get_tile(context, tiles::TileFormat::kCodes);
}

namespace {

boost::json::array corners(const tiles::Extent& extent) {
    return {rounded_metres(extent.min_x), rounded_metres(extent.min_y), rounded_metres(extent.max_x),
            rounded_metres(extent.max_y)};
}

} // namespace

Result<Response> get_tilejson(Context& context) {
    const auto found = find_maps(context);
    if (!found) return found.error();
    const auto layer = find_layer(context.arguments["layer"]);
    if (!layer) return layer.error();

    const auto& info = found->session->info();
    const double cell_size = found->snapshot->config.cell_size;
    const auto seen = mapping::bounds_of(*found->snapshot, *layer);
    auto address =
        fmt::format("/api/v1/sessions/{}/tiles/{}/{{z}}/{{x}}/{{y}}.png", info.name, mapping::name_of(*layer));
    if (const auto weave = context.query.find("weave")) address += fmt::format("?weave={}", *weave);
    return ok(boost::json::object{
        {"tilejson", "3.0.0"},
        {"name", info.name},
        {"scheme", "xyz"},
        {"tiles", boost::json::array{address}},
        {"vector_layers", boost::json::array{}},
        {"minzoom", 0},
        {"maxzoom", tiles::kZoomNative},
        {"cell_size", cell_size},
        {"extent", corners(tiles::tiled_extent(cell_size))},
        {"bounds_m", seen.empty() ? boost::json::value() : corners(tiles::extent_of(seen, cell_size))},
        {"frame_id", "map"}});
}

Result<Response> get_changes(Context& context) {
    const auto since = since_parameter(context.query);
    if (!since) return since.error();
    const auto found = find_maps(context);
    if (!found) return found.error();
    const auto layer = layer_parameter(context.query);
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
