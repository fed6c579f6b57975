#pragma once

#include <boost/json/object.hpp>

namespace scanloom::http {

/// Returns the OpenAPI description of this server.
///
/// Paths, parameters, security and the statuses of all similar operations come from routes(), the settings of a session
/// from mapping::config_fields(), texts and other schemas from openapi.yaml.
[[nodiscard]] const boost::json::object& openapi();

} // namespace scanloom::http
