#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../tiles/{layer}/{z}/{x}/{y}.png: grey, 0 occupied .. 255 free, 128 unknown.
///
/// `v` is a revision and `id` the session's: an answer that will never change under such an address
/// may be kept for good. Without them it must be asked for again, with its entity tag.
[[nodiscard]] Result<Response> get_tile_png(const MapsLookup& maps, const Call& call);

/// GET .../tiles/{layer}/{z}/{x}/{y}.bin: 65,536 bytes, row 0 on top; percent, 255 unknown.
[[nodiscard]] Result<Response> get_tile_bin(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
