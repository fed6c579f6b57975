#include "server/http/target.hpp"

#include "server/http/text.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>

namespace scanloom::http {
namespace {

bool has_control_character(std::string_view text) {
    return std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

/// Decodes once and after splitting, so that "%2F" never separates segments.
Result<std::vector<std::string>> parse_segments(std::string_view path) {
    std::vector<std::string> segments;
    for (std::size_t begin = 1; begin <= path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        auto segment = boost::urls::pct_string_view(path.substr(begin, end - begin)).decode();
        if (segment == "." || segment == ".." || segment.find_first_of("/\\") != std::string::npos ||
            has_control_character(segment)) {
            return Error{Errc::kMalformed, fmt::format("the path has the segment {}; write the path of a resource "
                                                       "plainly, without dots or encoded slashes",
                                                       in_quotes(segment))};
        }
        segments.push_back(std::move(segment));
        begin = end + 1;
    }
    return segments;
}

Result<Query> parse_query(const boost::urls::url_view& url) {
    std::vector<std::pair<std::string, std::string>> parameters;
    if (url.encoded_query().empty()) return Query(); // also after a '?'
    for (const auto& parameter : url.params()) {
        if (std::ranges::any_of(parameters, [&](const auto& seen) { return seen.first == parameter.key; })) {
            return Error{Errc::kInvalidField,
                         fmt::format("the parameter {} is given twice; give it once", in_quotes(parameter.key))};
        }
        parameters.emplace_back(parameter.key, parameter.value);
    }
    return Query(std::move(parameters));
}

} // namespace

std::optional<std::string_view> Query::find(std::string_view name) const {
    const auto found = std::ranges::find(parameters_, name, &std::pair<std::string, std::string>::first);
    if (found == parameters_.end()) return std::nullopt;
    return found->second;
}

Result<> Query::check_only(std::span<const std::string_view> known) const {
    for (const auto& [name, value] : parameters_) {
        if (std::ranges::find(known, name) != known.end()) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("the parameter {} is unknown here; {}", in_quotes(name),
                                 known.size() == 0 ? "this address takes none"
                                                   : fmt::format("possible are {}", fmt::join(known, ", ")))};
    }
    return {};
}

Result<Target> parse_target(std::string_view text) {
    const auto url = boost::urls::parse_origin_form(text);
    if (!url) {
        return Error{Errc::kMalformed, fmt::format("the request target {} is not a path with an optional query; "
                                                   "encode special characters with %",
                                                   in_quotes(text))};
    }
    auto segments = parse_segments(url->encoded_path());
    if (!segments) return segments.error();
    auto query = parse_query(*url);
    if (!query) return query.error();
    return Target{std::move(*segments), std::move(*query)};
}

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
