#pragma once

#include "lab/landmark_comparison.hpp"

#include "server/tiles/bytes.hpp"

#include <span>

namespace scanloom::lab {

/// Two captures of one frame as a PNG, at one scale: on the left the first capture in blue, on the right the second in
/// orange, each over the other one in pale. Landmarks that are matched are filled discs of the capture's colour with a
/// black rim, joined across the two by dashed lines; those that are not are red rings. The sensor is a black cross.
/// Throws std::runtime_error when OpenCV fails.
[[nodiscard]] tiles::Bytes comparison_png(const SeenLandmarks& first, const SeenLandmarks& second,
                                          std::span<const landmarks::Match> matches, const Point2& sensor);

} // namespace scanloom::lab
