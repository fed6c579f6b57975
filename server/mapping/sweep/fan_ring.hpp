#pragma once

#include "server/mapping/beam_fan.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::mapping {

/// A fan as the kernel walks around it: sectors that follow each other counter-clockwise and close the circle, the
/// parts that no beam sees among them. Sector m lies between the edges m and m + 1; the last edge is the first one.
///
/// Shapes  edges: sectors + 1 in use, then kRingPadding zeros, so that a vector may be loaded from any of them.
/// Frames  the sensor's; edges are unit vectors.
struct FanRing {
    static constexpr std::uint32_t kNoBeam = 0xFFFF'FFFFU;

    std::size_t sectors = 0;
    std::size_t in_order = 0;         ///< sectors, from the first: sector m is that of beam m
    std::vector<std::uint32_t> beams; ///< of each sector; kNoBeam: unseen
    std::vector<double> edges_x;
    std::vector<double> edges_y;
};

/// As many lanes of doubles as any vector has, and one more.
inline constexpr std::size_t kRingPadding = 40;

[[nodiscard]] FanRing make_fan_ring(const BeamFan& fan);

} // namespace scanloom::mapping
