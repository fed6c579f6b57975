#pragma once

#include "lab/landmark_comparison.hpp"

#include "server/tiles/bytes.hpp"

#include <span>

namespace scanloom::lab {

/// Draws two captures of one frame as a PNG, at one scale: on the left the first capture in blue, on the right the
/// second in orange, each over the other one in a pale colour. Matched landmarks are filled discs of the capture's
/// colour with a black rim, joined across both panels by dashed lines; unmatched ones are red rings. The sensor is a
/// black cross.
/// Errors: throws std::runtime_error if OpenCV fails.
[[nodiscard]] tiles::Bytes comparison_png(const SeenLandmarks& first, const SeenLandmarks& second,
                                          std::span<const landmarks::Match> matches, const Point2& sensor);

} // namespace scanloom::lab
