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

/// The parameters behind the '?', decoded, each of another name.
class Query {
public:
    Query() = default;
    explicit Query(std::vector<std::pair<std::string, std::string>> parameters) : parameters_(std::move(parameters)) {}

    /// The parameter's value; nothing when it was not given.
    [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;

    /// Errors  kInvalidField, naming the first parameter that is none of these.
    [[nodiscard]] Result<> check_only(std::initializer_list<std::string_view> known) const {
        return check_only(std::span(known.begin(), known.size()));
    }
    [[nodiscard]] Result<> check_only(std::span<const std::string_view> known) const;

private:
    std::vector<std::pair<std::string, std::string>> parameters_;
};

/// What a request asks for: the decoded segments of the path ("/" has one, which is empty) and the query.
struct Target {
    std::vector<std::string> segments;
    Query query;
};

/// Reads a request target in origin form, "/path?query", as RFC 3986 has it.
///
/// Errors  kMalformed: not of that form; a segment that is "." or "..", or decodes to something with
///         a slash or a control character. kInvalidField: a parameter that is given twice.
[[nodiscard]] Result<Target> parse_target(std::string_view text);

} // namespace scanloom::http
