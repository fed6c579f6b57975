#pragma once

#include <string_view>

namespace scanloom::http {

/// Whether an If-None-Match field says that its sender has what `etag` names.
///
/// `field` is "*" or a list of entity tags, compared weakly (W/ is ignored). A field that is
/// neither says nothing: the answer is then sent in full.
/// Pre     etag is an entity tag with its quotes.
/// Source  RFC 9110, sections 8.8.3.2 and 13.1.2.
[[nodiscard]] bool if_none_match_has(std::string_view field, std::string_view etag);

} // namespace scanloom::http
