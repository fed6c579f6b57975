#pragma once

#include "common/error/error.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::http {

/// One field of a form. The content is a view into the parsed body.
struct FormField {
    std::string name;
    std::string_view content;
};

inline constexpr std::size_t kFormFieldsMax = 64;

/// Returns whether a Content-Type field denotes multipart/form-data.
[[nodiscard]] bool is_form(std::string_view content_type);

/// Parses a multipart/form-data body, as browsers and `curl -F` send it. Ignores file names and types.
/// Errors: kMalformed if there is no boundary, the body is not divided by it, or a part has no name; kInvalidField if a
///         name is given twice.
/// Source: RFC 7578, RFC 2046 section 5.1.
[[nodiscard]] Result<std::vector<FormField>> parse_form(std::string_view content_type, std::string_view body);

} // namespace scanloom::http
