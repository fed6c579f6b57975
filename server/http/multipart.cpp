#include "server/http/multipart.hpp"

#include "server/http/text.hpp"

#include <boost/beast/core/string.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace scanloom::http {
namespace {

namespace beast = boost::beast;

Error malformed(std::string_view what) {
    return {Errc::kMalformed, fmt::format("the form is malformed: {}; send it as curl -F does", what)};
}

/// Returns a parameter after a header field's value, such as boundary="x", without its quotes.
std::optional<std::string> parameter(std::string_view value, std::string_view name) {
    const auto semicolon = value.find(';');
    if (semicolon == std::string_view::npos) return std::nullopt;
    const std::string list(value.substr(semicolon)); // param_list reads past the end of a view that no zero follows
    for (const auto& [key, text] : beast::http::param_list(list)) {
        if (!beast::iequals(key, beast::string_view(name.data(), name.size()))) continue;
        std::string_view unquoted(text.data(), text.size());
        const bool is_quoted = unquoted.size() >= 2 && unquoted.front() == '"' && unquoted.back() == '"';
        return std::string(is_quoted ? unquoted.substr(1, unquoted.size() - 2) : unquoted);
    }
    return std::nullopt;
}

/// Returns the name in a part's header.
std::optional<std::string> name_in(std::string_view header) {
    constexpr std::string_view kDisposition = "content-disposition:";
    while (!header.empty()) {
        const auto line = header.substr(0, header.find("\r\n"));
        header.remove_prefix(std::min(header.size(), line.size() + 2));
        const auto key = line.substr(0, std::min(line.size(), kDisposition.size()));
        if (beast::iequals({key.data(), key.size()}, {kDisposition.data(), kDisposition.size()})) {
            return parameter(line.substr(kDisposition.size()), "name");
        }
    }
    return std::nullopt;
}

} // namespace

bool is_form(std::string_view content_type) {
    constexpr std::string_view kForm = "multipart/form-data";
    const auto type = content_type.substr(0, std::min(content_type.find_first_of("; \t"), content_type.size()));
    return beast::iequals({type.data(), type.size()}, {kForm.data(), kForm.size()});
}

Result<std::vector<FormField>> parse_form(std::string_view content_type, std::string_view body) {
    const auto boundary = parameter(content_type, "boundary");
    if (!boundary || boundary->empty() || boundary->size() > 70) return malformed("its Content-Type has no boundary");
    const std::string delimiter = "\r\n--" + *boundary;
    if (!body.starts_with(std::string_view(delimiter).substr(2)))
        return malformed("it does not begin with its boundary");
    body.remove_prefix(delimiter.size() - 2);

    std::vector<FormField> fields;
    while (!body.starts_with("--")) { // "--" follows the last boundary
        if (!body.starts_with("\r\n")) return malformed("a boundary does not end its line");
        const auto header_end = body.find("\r\n\r\n");
        const auto end = header_end == std::string_view::npos ? header_end : body.find(delimiter, header_end + 2);
        if (end == std::string_view::npos) return malformed("its last part has no end");
        const auto name = name_in(body.substr(2, header_end));
        if (!name || name->empty()) return malformed("a part has no name");
        const bool is_known = std::ranges::any_of(fields, [&](const FormField& field) { return field.name == *name; });
        if (is_known) {
            return Error{Errc::kInvalidField,
                         fmt::format("the field {} is given twice; give it once", in_quotes(*name))};
        }
        if (fields.size() == kFormFieldsMax) return malformed("it has too many parts");
        const auto content_begin = header_end + 4;
        fields.push_back(
            {*name, end < content_begin ? std::string_view() : body.substr(content_begin, end - content_begin)});
        body.remove_prefix(end + delimiter.size());
    }
    return fields;
}

} // namespace scanloom::http
