#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/mapping/map_config.hpp"

#include <boost/json/object.hpp>

namespace scanloom::http {

/// Every setting, by its name.
[[nodiscard]] boost::json::object to_json(const mapping::MapConfig& config);

/// Sets what the object has members for; leaves the rest. Ranges are for resolve() to check.
/// Errors  kInvalidField, naming the member: a value of another kind.
[[nodiscard]] Result<> read_options(const boost::json::object& object, SessionOptions& options);

} // namespace scanloom::http
