#pragma once

#include <string_view>

namespace scanloom::http {

/// Returns whether an If-None-Match field contains `etag`.
///
/// @param field  "*" or a list of entity tags, compared weakly (W/ is ignored); a malformed field matches nothing, so
///               that the response is sent in full
/// @param etag   an entity tag with its quotes
/// Source: RFC 9110, sections 8.8.3.2 and 13.1.2.
[[nodiscard]] bool if_none_match_has(std::string_view field, std::string_view etag);

} // namespace scanloom::http
