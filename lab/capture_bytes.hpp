#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"

#include <cstddef>
#include <span>

namespace scanloom::lab {

/// Bytes of the frames that a robot sends for some scans: a batch of Protocol Buffers for each, as while it measures,
/// with length prefix and checksum.
[[nodiscard]] std::size_t robot_bytes(std::span<const Scan> scans);

/// Bytes that survey_landmarks() holds while it clusters points: the points, those of them that are distinct, the grid
/// over these, and what is kept for each cell and each point. It is reckoned from the sizes of the elements, all points
/// taken for core points; without spare room of vectors, and without the search trees of crowded cells.
/// Pre  the points pass check_points(); eps as check_eps() takes it.
[[nodiscard]] std::size_t clustering_bytes(std::span<const Point2> points, double eps);

} // namespace scanloom::lab
