#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {

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
