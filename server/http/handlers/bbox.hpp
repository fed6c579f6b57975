#pragma once

#include "common/error/error.hpp"
#include "server/http/target.hpp"
#include "server/tiles/extent.hpp"

#include <optional>

namespace scanloom::http {

/// The bbox parameter, `min_x,min_y,max_x,max_y` in metres; nothing when it is not given.
/// Errors  kInvalidField: not four numbers.
[[nodiscard]] Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query);

} // namespace scanloom::http
