#pragma once

#include <boost/json/value.hpp>

#include <string>

namespace scanloom {

/// JSON as text in which numbers read as people write them: the shortest digits that give the same
/// number, 0.05 where Boost.JSON itself has 5E-2; with an exponent only below 1e-6 and from 1e21 on. What is not finite
/// becomes null.
/// Pre  a value this program built: its depth is not checked.
[[nodiscard]] std::string json_text(const boost::json::value& value);

} // namespace scanloom
