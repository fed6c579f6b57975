#include "server/tiles/ros_map.hpp"

#include "server/tiles/occupancy_percent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace scanloom::tiles {
namespace {

std::uint8_t trinary_grey(Percent percent) noexcept {
    if (percent <= 25) return 254;
    if (percent >= 65 && percent <= 100) return 0;
    return 205;
}

} // namespace

Bytes map_pgm(const MapImage& image) {
    const auto& frame = image.frame;
    const auto header = fmt::format("P5\n# CREATOR: Scanloom {:.3f} m/pix\n{} {}\n255\n", frame.cell_size,
                                    frame.width(), frame.height());
    Bytes pgm;
    pgm.reserve(header.size() + image.percent.size());
    pgm.assign(header.begin(), header.end());
    std::transform(image.percent.begin(), image.percent.end(), std::back_inserter(pgm), trinary_grey);
    return pgm;
}

std::string map_yaml(const MapFrame& frame) {
    // 15 digits drop the last bits' noise of cell * cell_size: -5.05, not -5.050000000000001.
    // Unknown is p = 50 / 255 = 0.19608 to those who load it: just above free_thresh.
    const auto origin = frame.origin();
    return fmt::format("image: map.pgm\n"
                       "mode: trinary\n"
                       "resolution: {:.15g}\n"
                       "origin: [{:.15g}, {:.15g}, 0]\n"
                       "negate: 0\n"
                       "occupied_thresh: 0.65\n"
                       "free_thresh: 0.196\n",
                       frame.cell_size, origin.x(), origin.y());
}

} // namespace scanloom::tiles
