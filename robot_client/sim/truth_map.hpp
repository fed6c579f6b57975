#pragma once

#include "robot_client/sim/truth_grid.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Write the truth as the two files of ROS map_saver: occupied, free, and unknown outside.

/// Returns a binary PGM, top row first.
[[nodiscard]] std::vector<std::uint8_t> truth_pgm(const TruthGrid& truth);

/// Returns the YAML description. `image` is the file name of the PGM in the same folder.
[[nodiscard]] std::string truth_yaml(const TruthGrid& truth, std::string_view image);

} // namespace scanloom::robot
