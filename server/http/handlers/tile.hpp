#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/lane.hpp"
#include "server/http/response.hpp"
#include "server/tiles/tile_maker.hpp"

namespace scanloom::http {

/// GET .../tiles/{layer}/{z}/{x}/{y}.png, in the colours of style_of(layer), and .bin: 65,536 codes, row 0 on top.
///
/// The parameters are `v`, a revision, and `id`, that of the session. A response that cannot change for these
/// parameters may be cached without limit. Without them the client must revalidate it with its entity tag.
[[nodiscard]] Result<Response> get_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call,
                                        tiles::TileFormat format);

/// Does as much of get_tile() as takes microseconds, for I/O threads.
/// @return a refusal, "not modified", or a tile that exists; else the lane on which to call get_tile()
[[nodiscard]] Result<Outlook> look_at_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call,
                                           tiles::TileFormat format);

} // namespace scanloom::http
