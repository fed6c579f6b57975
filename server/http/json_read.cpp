#include "server/http/json_read.hpp"

#include "server/http/in_quotes.hpp"
#include "server/http/json_keys.hpp"

#include <boost/json/parse.hpp>
#include <boost/url/grammar/ci_string.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace scanloom::http {

bool is_json(std::string_view content_type) {
    auto type = content_type.substr(0, content_type.find(';'));
    const auto end = type.find_last_not_of(" \t");
    type = type.substr(0, end == std::string_view::npos ? 0 : end + 1);
    return boost::urls::grammar::ci_is_equal(type, "application/json");
}

Result<boost::json::object> parse_json_object(std::string_view body) {
    boost::json::parse_options options;
    options.max_depth = 8;
    boost::json::error_code failed;
    auto value = boost::json::parse(body, failed, {}, options);
    if (failed) return Error{Errc::kMalformed, fmt::format("the body is not JSON: {}", failed.message())};
    if (!value.is_object())
        return Error{Errc::kMalformed, "the body is JSON but not an object; send {\"field\": value, ...}"};
    if (const auto twice = duplicate_key(body)) {
        return Error{Errc::kInvalidField, fmt::format("the field {} is given twice; give it once", in_quotes(*twice))};
    }
    return std::move(value.get_object());
}

Result<> check_members(const boost::json::object& object, std::span<const std::string_view> known) {
    for (const auto& member : object) {
        const std::string_view name(member.key().data(), member.key().size());
        if (std::ranges::find(known, name) != known.end()) continue;
        return Error{Errc::kInvalidField, fmt::format("the field {} is unknown here; possible are {}", in_quotes(name),
                                                      fmt::join(known, ", "))};
    }
    return {};
}

Result<std::string> read_text(const boost::json::object& object, std::string_view name) {
    const auto* value = object.if_contains(name);
    if (value == nullptr) return Error{Errc::kInvalidField, fmt::format("{} is missing; a string is needed", name)};
    if (!value->is_string()) return Error{Errc::kInvalidField, fmt::format("{} is not a string", name)};
    return std::string(value->get_string().data(), value->get_string().size());
}

Result<std::optional<double>> read_number(const boost::json::object& object, std::string_view name) {
    const auto* value = object.if_contains(name);
    if (value == nullptr) return std::optional<double>();
    if (!value->is_number()) return Error{Errc::kInvalidField, fmt::format("{} is not a number", name)};
    const double number = value->to_number<double>();
    if (!std::isfinite(number)) return Error{Errc::kInvalidField, fmt::format("{} is too large for a number", name)};
    return std::optional<double>(number);
}

} // namespace scanloom::http
