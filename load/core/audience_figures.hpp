#pragma once

#include "load/core/latency_histogram.hpp"

#include <cstdint>
#include <string>

namespace scanloom::load {

/// What those have seen who look on while robots stream.
struct AudienceFigures {
    std::uint32_t watching = 0;        ///< viewers that are connected at present
    std::uint32_t viewers_let_in = 0;  ///< viewers that have ever watched
    std::uint32_t viewers_refused = 0; ///< that never have, as the server answered otherwise than by letting them in
    std::uint64_t events = 0;
    std::uint64_t event_bytes = 0;
    std::uint64_t viewer_ends = 0; ///< connections of viewers that watched, ended without their doing

    std::uint64_t tile_requests = 0;
    std::uint64_t tiles_unchanged = 0; ///< answered 304
    std::uint64_t tiles_failed = 0;    ///< answered otherwise than 200 and 304, or not at all
    std::uint64_t tile_bytes = 0;
    LatencyHistogram tile_latency; ///< from when a tile was meant to be asked for until it was there

    std::string trouble; ///< the newest; empty: none
};

} // namespace scanloom::load
