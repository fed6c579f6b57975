#pragma once

#include "tests/bench/projection/columns.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::bench {

/// Integrates one scan of a column into a map.
class Mapper {
public:
    virtual ~Mapper() = default;
    virtual void insert(const Scan& scan) = 0;

protected:
    Mapper() = default;
    Mapper(const Mapper&) = default;
    Mapper& operator=(const Mapper&) = default;
};

/// A mapper with which the projection is compared in the same run.
struct Peer {
    std::string name;
    std::function<std::unique_ptr<Mapper>(const Column&)> make;
};

/// Returns the mappers. Each reimplements the idea of a known mapper, except "mrpt", which is that library.
///   - bresenham: float log-odds along each beam, as in a simple implementation
///   - once_a_scan: float log-odds, each cell once per scan, a hit overrides a miss; beams without a return are
///     ignored, as in Hector SLAM
///   - mark_and_clear: bytes; each beam clears its cells, then hits are marked, as in Nav2's obstacle layer
///   - mrpt: COccupancyGridMap2D, if this was built with MRPT
///   - fill_poly: OpenCV fills the polygon of the beams' ends, whose cells are decremented with saturation. Not a
///     mapper: it has no occupied cells, and joins the ends across directions without a beam
///   - spans: a limit: adds with saturation to exactly the rows of cells that the exact model frees or occupies, which
///     were computed before
[[nodiscard]] const std::vector<Peer>& peers();

/// Returns MRPT as a mapper; empty if MRPT is not installed.
[[nodiscard]] std::vector<Peer> mrpt_peer();

/// Returns MRPT's version; empty if MRPT is not installed.
[[nodiscard]] std::string mrpt_version();

} // namespace scanloom::bench
