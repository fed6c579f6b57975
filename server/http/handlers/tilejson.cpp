#include "server/http/handlers/tilejson.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/number.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/tile_key.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <fmt/format.h>

namespace scanloom::http {
namespace {

boost::json::array corners(const tiles::Extent& extent) {
    return {rounded_metres(extent.min_x), rounded_metres(extent.min_y), rounded_metres(extent.max_x),
            rounded_metres(extent.max_y)};
}

} // namespace

Result<Response> get_tilejson(const MapsLookup& maps, const Call& call) {
    const auto found = maps.find(call, {});
    if (!found) return found.error();
    const auto layer = find_layer(call.arguments["layer"]);
    if (!layer) return layer.error();

    const auto& info = found->session->info();
    const double cell_size = found->snapshot->config.cell_size;
    const auto seen = mapping::bounds_of(*found->snapshot, *layer);
    auto address =
        fmt::format("/api/v1/sessions/{}/tiles/{}/{{z}}/{{x}}/{{y}}.png", info.name, mapping::name_of(*layer));
    if (const auto weave = call.query.find("weave")) address += fmt::format("?weave={}", *weave);
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

} // namespace scanloom::http
