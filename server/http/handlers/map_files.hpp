#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../map.png, .../map.pgm, .../map.yaml, .../map.csv, .../map.npy: returns the whole map of a layer, or with
/// `bbox=min_x,min_y,max_x,max_y` (metres) the cells that overlap this rectangle. ROS loads the PGM and the YAML.
///
/// A large file takes a slot until its last byte is sent. If no slot is free, the response is 503.
[[nodiscard]] Result<Response> get_map_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_pgm(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_csv(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_npy(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);
[[nodiscard]] Result<Response> get_map_yaml(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
