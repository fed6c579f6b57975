#pragma once

#include "common/error/error.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::http {

/// One field of a form. The content lies in the body that was parsed.
struct FormField {
    std::string name;
    std::string_view content;
};

inline constexpr std::size_t kFormFieldsMax = 64;

/// Whether a Content-Type field says multipart/form-data.
[[nodiscard]] bool is_form(std::string_view content_type);

/// The fields of a multipart/form-data body, as browsers and `curl -F` send it. File names and types are not looked at.
/// Errors  kMalformed: no boundary, a body that is not divided by it, a part without a name; kInvalidField: a name that
///         is given twice.
/// Source  RFC 7578, RFC 2046 section 5.1.
[[nodiscard]] Result<std::vector<FormField>> parse_form(std::string_view content_type, std::string_view body);

} // namespace scanloom::http
