#include "server/mapping/sweep/fan_ring.hpp"

namespace scanloom::mapping {
namespace {

/// Sectors that meet hold exactly the same direction.
bool meet(const Direction& high, const Direction& low) { return high.x == low.x && high.y == low.y; }

void append(FanRing& ring, std::uint32_t beam, const Direction& low) {
    ring.beams.push_back(beam);
    ring.edges_x.push_back(low.x);
    ring.edges_y.push_back(low.y);
}

} // namespace

FanRing make_fan_ring(const BeamFan& fan) {
    FanRing ring;
    for (std::size_t n = 0; n < fan.size(); ++n) {
        const Direction& next = fan[(n + 1) % fan.size()].low;
        append(ring, fan[n].beam, fan[n].low);
        if (!meet(fan[n].high, next)) append(ring, FanRing::kNoBeam, fan[n].high);
    }
    ring.sectors = ring.beams.size();
    while (ring.in_order < ring.sectors && ring.beams[ring.in_order] == ring.in_order) ++ring.in_order;
    ring.edges_x.push_back(fan.front().low.x);
    ring.edges_y.push_back(fan.front().low.y);
    ring.edges_x.resize(ring.edges_x.size() + kRingPadding);
    ring.edges_y.resize(ring.edges_y.size() + kRingPadding);
    return ring;
}

} // namespace scanloom::mapping
