#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/mapping/map_config.hpp"

#include <boost/json/object.hpp>

namespace scanloom::http {

/// Returns every setting by its name.
[[nodiscard]] boost::json::object to_json(const mapping::MapConfig& config);

/// Sets the options that `object` has members for and keeps the others. resolve() checks the ranges.
/// Errors: kInvalidField, naming the member, if a value has another type.
[[nodiscard]] Result<> read_options(const boost::json::object& object, SessionOptions& options);

} // namespace scanloom::http
