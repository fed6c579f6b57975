#include "server/http/json_read.hpp"

#include "server/http/text.hpp"

#include <boost/json/basic_parser_impl.hpp>
#include <boost/json/parse.hpp>
#include <boost/url/grammar/ci_string.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// The parser's handler: called for each part of a JSON text; returning false ends the parsing.
struct KeyWatch {
    static constexpr std::size_t max_object_size = SIZE_MAX;
    static constexpr std::size_t max_array_size = SIZE_MAX;
    static constexpr std::size_t max_key_size = SIZE_MAX;
    static constexpr std::size_t max_string_size = SIZE_MAX;

    using Failed = boost::json::error_code;
    using Text = boost::json::string_view;

    bool on_object_begin(Failed&) {
        open_.emplace_back();
        return true;
    }
    bool on_object_end(std::size_t, Failed&) {
        open_.pop_back();
        return true;
    }
    bool on_key_part(Text text, std::size_t, Failed&) {
        key_.append(text.data(), text.size());
        return true;
    }
    bool on_key(Text text, std::size_t, Failed&) {
        key_.append(text.data(), text.size());
        if (open_.back().insert(key_).second) {
            key_.clear();
            return true;
        }
        duplicate = std::move(key_);
        return false;
    }

    bool on_document_begin(Failed&) { return true; }
    bool on_document_end(Failed&) { return true; }
    bool on_array_begin(Failed&) { return true; }
    bool on_array_end(std::size_t, Failed&) { return true; }
    bool on_string_part(Text, std::size_t, Failed&) { return true; }
    bool on_string(Text, std::size_t, Failed&) { return true; }
    bool on_number_part(Text, Failed&) { return true; }
    bool on_int64(std::int64_t, Text, Failed&) { return true; }
    bool on_uint64(std::uint64_t, Text, Failed&) { return true; }
    bool on_double(double, Text, Failed&) { return true; }
    bool on_bool(bool, Failed&) { return true; }
    bool on_null(Failed&) { return true; }
    bool on_comment_part(Text, Failed&) { return true; }
    bool on_comment(Text, Failed&) { return true; }

    std::optional<std::string> duplicate;

private:
    std::vector<std::set<std::string>> open_; // keys of the enclosing objects, outermost first
    std::string key_;
};

} // namespace

std::optional<std::string> duplicate_key(std::string_view json) {
    boost::json::basic_parser<KeyWatch> parser({});
    boost::json::error_code ignored; // the callers check that it is well-formed
    parser.write_some(false, json.data(), json.size(), ignored);
    return std::move(parser.handler().duplicate);
}

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

Result<boost::json::object> parse_json_object(std::string_view body, std::span<const std::string_view> known) {
    auto object = parse_json_object(body);
    if (!object) return object;
    if (auto allowed = check_members(*object, known); !allowed) return allowed.error();
    return object;
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

Result<std::optional<bool>> read_flag(const boost::json::object& object, std::string_view name) {
    const auto* value = object.if_contains(name);
    if (value == nullptr) return std::optional<bool>();
    if (!value->is_bool()) return Error{Errc::kInvalidField, fmt::format("{} is neither true nor false", name)};
    return std::optional<bool>(value->get_bool());
}

} // namespace scanloom::http
