#include "server/http/conditional.hpp"

#include <algorithm>

namespace scanloom::http {
namespace {

void skip(std::string_view& text, std::string_view characters) {
    text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
}

/// Removes one entity tag from the front and returns it without its W/; empty if there is none.
std::string_view take_tag(std::string_view& text) {
    if (text.starts_with("W/")) text.remove_prefix(2);
    if (!text.starts_with('"')) return {};
    const auto close = text.find('"', 1);
    if (close == std::string_view::npos) return {};
    const auto tag = text.substr(0, close + 1);
    text.remove_prefix(tag.size());
    return tag;
}

} // namespace

bool if_none_match_has(std::string_view field, std::string_view etag) {
    constexpr std::string_view kBlank = " \t";
    skip(field, kBlank);
    if (field.starts_with('*')) return field.find_first_not_of(" \t", 1) == std::string_view::npos;
    bool found = false;
    while (!field.empty()) {
        const auto tag = take_tag(field);
        if (tag.empty()) return false;
        found = found || tag == etag;
        skip(field, kBlank);
        if (!field.empty() && !field.starts_with(',')) return false;
        skip(field, ", \t"); // lists may contain empty elements
    }
    return found;
}

} // namespace scanloom::http
