#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"

#include <cstddef>
#include <span>

namespace scanloom::lab {

/// Returns the size of the frames that a robot sends for some scans, in bytes: one Protocol Buffers batch per scan, as
/// during measurement, with length prefix and checksum.
[[nodiscard]] std::size_t robot_bytes(std::span<const Scan> scans);

/// Returns the bytes that survey_landmarks() holds while it clusters points: the points, the distinct ones among them,
/// the grid over these, and the data for each cell and each point. The value is computed from the sizes of the elements
/// with all points taken as core points; spare capacity of vectors and the search trees of crowded cells are not
/// included.
/// Pre: the points pass check_points(), and eps passes check_eps().
[[nodiscard]] std::size_t clustering_bytes(std::span<const Point2> points, double eps);

} // namespace scanloom::lab
