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

/// Each stands for what a known mapper does, written anew from its idea; "mrpt" is that library itself.
///   bresenham       float log-odds along each beam, as one writes it by hand
///   once_a_scan     float log-odds, each cell once a scan, a hit beating a pass; beams without a return are left out:
///   as
///                   Hector SLAM does it
///   mark_and_clear  bytes; each beam clears its cells, then hits are marked: as Nav2's obstacle layer does it
///   mrpt            COccupancyGridMap2D, where this was built with it
///   fill_poly       OpenCV fills the polygon of the beams' ends, its cells are taken off with saturation. No mapper:
///   it knows
///                   no occupied cells, and joins the ends where no beam has been
///   spans           a limit: adds with saturation to the very rows of cells that the exact model frees or occupies,
///   which
///                   were found before
[[nodiscard]] const std::vector<Peer>& peers();

/// Where MRPT is not installed: nothing.
[[nodiscard]] std::vector<Peer> mrpt_peer();

/// Empty where MRPT is not installed.
[[nodiscard]] std::string mrpt_version();

} // namespace scanloom::bench
