#pragma once

#include "common/error/error.hpp"
#include "server/http/target.hpp"
#include "server/tiles/map_image.hpp"

#include <optional>

namespace scanloom::http {

/// Returns the bbox parameter, `min_x,min_y,max_x,max_y` in metres, or nullopt if it is not given.
/// Errors: kInvalidField if it is not four numbers.
[[nodiscard]] Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query);

} // namespace scanloom::http
