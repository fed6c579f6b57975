#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/lane.hpp"
#include "server/http/response.hpp"
#include "server/tiles/tile_maker.hpp"

namespace scanloom::http {

/// GET .../tiles/{layer}/{z}/{x}/{y}.png, in the colours of style_of(layer), and .bin: 65,536 codes, row 0 on top.
///
/// `v` is a revision and `id` the session's: an answer that will never change under such an address
/// may be kept for good. Without them it must be asked for again, with its entity tag.
[[nodiscard]] Result<Response> get_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call,
                                        tiles::TileFormat format);

/// The same as far as it goes in microseconds, for I/O threads: a refusal, "not modified", or a tile that is there;
/// else on which lane get_tile() is to be called.
[[nodiscard]] Result<Outlook> look_at_tile(const MapsLookup& maps, tiles::TileMaker& maker, const Call& call,
                                           tiles::TileFormat format);

} // namespace scanloom::http
