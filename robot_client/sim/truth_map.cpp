#include "robot_client/sim/truth_map.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"

#include <algorithm>
#include <iterator>
#include <span>

namespace scanloom::robot {
namespace {

std::uint8_t grey_of(Truth truth) {
    switch (truth) {
    case Truth::kOccupied: return kRosGreyOccupied;
    case Truth::kFree: return kRosGreyFree;
    case Truth::kOutside: break;
    }
    return kRosGreyUnknown;
}

} // namespace

std::vector<std::uint8_t> truth_pgm(const TruthGrid& truth) {
    const auto width = static_cast<std::size_t>(truth.width);
    const auto height = static_cast<std::size_t>(truth.height);
    const auto header = ros_pgm_header(width, height, truth.cell_size);
    std::vector<std::uint8_t> pgm(header.begin(), header.end());
    pgm.reserve(header.size() + width * height);
    for (std::size_t row = height; row-- > 0;) {
        std::ranges::transform(std::span(truth.cells).subspan(row * width, width), std::back_inserter(pgm), grey_of);
    }
    return pgm;
}

std::string truth_yaml(const TruthGrid& truth, std::string_view image) {
    return ros_yaml(image, truth.cell_size, truth.i_begin * truth.cell_size, truth.j_begin * truth.cell_size);
}

} // namespace scanloom::robot
