#pragma once

#include "common/error/error.hpp"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {

/// The decoded parameters after the '?', with distinct names.
class Query {
public:
    Query() = default;
    explicit Query(std::vector<std::pair<std::string, std::string>> parameters) : parameters_(std::move(parameters)) {}

    /// Returns the parameter's value, or nullopt if it is not given.
    [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;

    /// Errors: kInvalidField, naming the first parameter that is not in `known`.
    [[nodiscard]] Result<> check_only(std::initializer_list<std::string_view> known) const {
        return check_only(std::span(known.begin(), known.size()));
    }
    [[nodiscard]] Result<> check_only(std::span<const std::string_view> known) const;

private:
    std::vector<std::pair<std::string, std::string>> parameters_;
};

/// A parsed request target: the decoded segments of the path ("/" has one, which is empty) and the query.
struct Target {
    std::vector<std::string> segments;
    Query query;
};

/// Parses a request target in origin form, "/path?query" (RFC 3986).
///
/// Errors: kMalformed if it has another form, or a segment is "." or "..", or decodes to text with a slash or a control
///         character; kInvalidField if a parameter is given twice.
[[nodiscard]] Result<Target> parse_target(std::string_view text);

/// The text that the named segments of a path pattern matched.
class Arguments {
public:
    void add(std::string_view name, std::string value) { values_.emplace_back(name, std::move(value)); }

    /// @param name  occurs in the pattern
    [[nodiscard]] const std::string& operator[](std::string_view name) const;

private:
    std::vector<std::pair<std::string_view, std::string>> values_;
};

/// Matches the decoded segments of a path against a pattern such as "/tiles/{layer}/{y}.png". A segment of the pattern
/// is literal, or "{name}" with an optional ending, which matches any text before that ending.
/// @return the arguments, whose names refer to `pattern`; nullopt if the path does not match
[[nodiscard]] std::optional<Arguments> match_path(std::string_view pattern, const std::vector<std::string>& segments);

} // namespace scanloom::http
