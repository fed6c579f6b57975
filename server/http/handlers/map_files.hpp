#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../map.png, .../map.pgm, .../map.yaml, .../map.csv, .../map.npy: the whole map of a layer, or with
/// `bbox=min_x,min_y,max_x,max_y` (metres) the cells which that rectangle overlaps. The PGM and the YAML are what ROS
/// loads.
///
/// A large file takes a slot until its last byte was sent; when there is none, the answer is 503.
[[nodiscard]] Result<Response> get_map_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_pgm(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_csv(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_npy(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_yaml(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
