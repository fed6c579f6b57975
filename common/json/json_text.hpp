#pragma once

#include <boost/json/value.hpp>

#include <string>

namespace scanloom {

/// Serializes a JSON value with numbers in decimal notation.
///
/// A number has the shortest digits that parse to the same number: 0.05, where Boost.JSON itself writes 5E-2. It has an
/// exponent only if its magnitude is below 1e-6 or at least 1e21. NaN and infinity become null.
/// Precondition: this program built `value`; the nesting depth is not checked.
[[nodiscard]] std::string json_text(const boost::json::value& value);

} // namespace scanloom
