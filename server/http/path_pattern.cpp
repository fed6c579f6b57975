#include "server/http/path_pattern.hpp"

#include <algorithm>
#include <cassert>

namespace scanloom::http {
namespace {

/// Removes the first segment from a pattern that begins with '/', and returns it.
std::string_view take_segment(std::string_view& pattern) {
    pattern.remove_prefix(1);
    const auto segment = pattern.substr(0, pattern.find('/'));
    pattern.remove_prefix(segment.size());
    return segment;
}

bool match_segment(std::string_view pattern, const std::string& segment, Arguments& arguments) {
    if (!pattern.starts_with('{')) return pattern == segment;
    const auto close = pattern.find('}');
    const auto ending = pattern.substr(close + 1);
    if (segment.size() <= ending.size() || !segment.ends_with(ending)) return false;
    arguments.add(pattern.substr(1, close - 1), segment.substr(0, segment.size() - ending.size()));
    return true;
}

} // namespace

const std::string& Arguments::operator[](std::string_view name) const {
    const auto found = std::ranges::find(values_, name, &std::pair<std::string_view, std::string>::first);
    assert(found != values_.end());
    return found->second;
}

std::optional<Arguments> match_path(std::string_view pattern, const std::vector<std::string>& segments) {
    Arguments arguments;
    for (const auto& segment : segments) {
        if (pattern.empty() || !match_segment(take_segment(pattern), segment, arguments)) return std::nullopt;
    }
    if (!pattern.empty()) return std::nullopt;
    return arguments;
}

} // namespace scanloom::http
