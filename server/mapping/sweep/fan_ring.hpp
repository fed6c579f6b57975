#pragma once

#include "server/mapping/beam_fan.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::mapping {

/// A fan as a closed ring of sectors in counter-clockwise order, including the parts that no beam sees. Sector m lies
/// between the edges m and m + 1; the last edge equals the first.
///
/// The edges are unit vectors in the sensor frame: sectors + 1 values, then kRingPadding zeros, so that a vector
/// register can be loaded from any edge.
struct FanRing {
    static constexpr std::uint32_t kNoBeam = 0xFFFF'FFFFU;

    std::size_t sectors = 0;
    std::size_t in_order = 0;         ///< number of leading sectors for which sector m belongs to beam m
    std::vector<std::uint32_t> beams; ///< beam of each sector; kNoBeam: unseen
    std::vector<double> edges_x;
    std::vector<double> edges_y;
};

/// More values than any vector register has lanes of doubles.
inline constexpr std::size_t kRingPadding = 40;

/// Returns the fan as a ring, with the parts that no beam sees added.
[[nodiscard]] FanRing make_fan_ring(const BeamFan& fan);

} // namespace scanloom::mapping
