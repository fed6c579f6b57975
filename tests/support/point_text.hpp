#pragma once

#include "common/geometry/point2.hpp"

#include <fmt/format.h>

#include <string>

namespace scanloom::testing_support {

/// Returns a point in the form that failed tests print.
[[nodiscard]] inline std::string text_of(const Point2& point) { return fmt::format("({:g}, {:g})", point.x, point.y); }

} // namespace scanloom::testing_support
