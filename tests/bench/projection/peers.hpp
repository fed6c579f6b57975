#pragma once

#include "tests/bench/projection/columns.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::bench {

/// Puts one scan of a column into a map.
class Mapper {
public:
    virtual ~Mapper() = default;
    virtual void insert(const Scan& scan) = 0;

protected:
    Mapper() = default;
    Mapper(const Mapper&) = default;
    Mapper& operator=(const Mapper&) = default;
};

/// What the projection is measured beside, in the same run.
struct Peer {
    std::string name;
    std::function<std::unique_ptr<Mapper>(const Column&)> make;
};

/// "bresenham": float log-odds along each beam. "mark_and_clear": bytes, as of costmaps: each beam clears its cells,
/// then hits are marked. "once_a_scan": float log-odds, each cell once a scan, a hit beating a pass, as mappers do that
/// count updates by scan. "fill_poly": OpenCV fills the polygon of the beams' ends, its cells are taken off with
/// saturation. "mrpt": COccupancyGridMap2D, where this was built with it. Two are limits rather than mappers: "spans"
/// adds with saturation to the very rows of cells that the exact model frees or occupies, which were found before.
[[nodiscard]] const std::vector<Peer>& peers();

/// Where MRPT is not installed: nothing.
[[nodiscard]] std::vector<Peer> mrpt_peer();

} // namespace scanloom::bench
