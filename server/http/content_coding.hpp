#pragma once

#include "server/http/response.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Whether an Accept-Encoding field lets an answer be sent as gzip. A field that is no list of codings does not.
/// @param field  all such fields, joined with commas; empty when absent
/// Source  RFC 9110, section 12.5.3.
[[nodiscard]] bool accepts_gzip(std::string_view field);

/// A text of more than a packet as gzip (RFC 1952); null where the content is no text, gzip makes it no smaller, or
/// there is no memory for it.
[[nodiscard]] std::shared_ptr<const std::string> gzip_of(std::string_view content_type, std::string_view text);

/// The answer as the client takes it: texts of more than a packet as gzip, where that makes them smaller and
/// `accept_encoding` lets it. An entity tag becomes weak, as the bytes differ from those of the plain answer.
/// Images, NumPy arrays and what is read piece by piece stay as they are.
/// Source  RFC 9110, sections 8.4, 8.8.1 and 12.5.5.
[[nodiscard]] Response encoded_for(std::string_view accept_encoding, Response response);

} // namespace scanloom::http
