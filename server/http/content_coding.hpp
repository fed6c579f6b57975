#pragma once

#include "server/http/response.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns whether an Accept-Encoding field permits a gzip response. A malformed field does not.
/// @param field  all such fields, joined with commas; empty if absent
/// Source: RFC 9110, section 12.5.3.
[[nodiscard]] bool accepts_gzip(std::string_view field);

/// Compresses a text that does not fit into one packet with gzip (RFC 1952).
/// @return null if the text is shorter, the content type is not text, gzip does not make it smaller, or memory is short
[[nodiscard]] std::shared_ptr<const std::string> gzip_of(std::string_view content_type, std::string_view text);

/// Compresses the body of `response` with gzip if `accept_encoding` permits it and gzip_of() makes it smaller. The
/// entity tag then becomes weak, because the bytes differ from the plain response. Images, NumPy arrays and streams
/// stay as they are.
/// Source: RFC 9110, sections 8.4, 8.8.1 and 12.5.5.
[[nodiscard]] Response encoded_for(std::string_view accept_encoding, Response response);

} // namespace scanloom::http
