#pragma once

#include "robot_client/sim/truth_grid.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// The truth as the file pair of ROS map_saver: occupied, free, and unknown outside.

/// Binary PGM, top row first.
[[nodiscard]] std::vector<std::uint8_t> truth_pgm(const TruthGrid& truth);

/// The description that goes with it; `image` is its file, beside this one.
[[nodiscard]] std::string truth_yaml(const TruthGrid& truth, std::string_view image);

} // namespace scanloom::robot
