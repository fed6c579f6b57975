#pragma once

#include "load/core/latency_histogram.hpp"

#include <cstdint>
#include <string>

namespace scanloom::load {

/// Statistics of the viewers and tile readers during a run.
struct AudienceFigures {
    std::uint32_t watching = 0;        ///< viewers currently connected
    std::uint32_t viewers_let_in = 0;  ///< viewers that have ever watched
    std::uint32_t viewers_refused = 0; ///< viewers that never watched because the server refused them
    std::uint64_t events = 0;
    std::uint64_t event_bytes = 0;
    std::uint64_t viewer_ends = 0; ///< connections of watching viewers that ended other than by stop()

    std::uint64_t tile_requests = 0;
    std::uint64_t tiles_unchanged = 0; ///< answered 304
    std::uint64_t tiles_failed = 0;    ///< not answered with 200 or 304, or not at all
    std::uint64_t tile_bytes = 0;
    LatencyHistogram tile_latency; ///< from the intended time of a request until the tile had arrived

    std::string trouble; ///< the most recent one; empty: none
};

} // namespace scanloom::load
