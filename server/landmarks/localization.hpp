#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/alignment.hpp"
#include "server/landmarks/reference_layer.hpp"

#include <functional>
#include <optional>

namespace scanloom::landmarks {

/// A part of the map: no more than `radius` metres from its middle, along each axis.
struct Neighbourhood {
    Point2 middle{0.0, 0.0}; ///< metres, map frame
    double radius = 0.0;     ///< metres, more than 0
};

/// Where in a map a view was taken, without any guess: as align() does for two views, everywhere that robots have
/// looked at. T_first_second takes the view's frame into the map's.
///
/// Certainty  as of Alignment: clear only where no other place of the map, or of the neighbourhood, explains the view
///            nearly as well. `explained` is the part of the view that is in the map.
/// @param ask  now and then, as it may take seconds in a large map; its error ends it
/// Errors  kNothingMapped: no laser has seen anything, wherever it was. kTooLarge: the map is more than 200 m wide, and no
///         neighbourhood says where to look. Those of check_view() and of `ask`.
/// Cost    as of align(), and for each of some 100 rotations, surface elements of the map times 250.
/// Source  as of align().
[[nodiscard]] Result<Alignment> locate(
    const ReferenceViews& map, const CloudView& view, const std::optional<Neighbourhood>& near = {},
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
