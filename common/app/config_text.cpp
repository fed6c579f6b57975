#include "common/app/config_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <istream>
#include <optional>
#include <vector>

namespace scanloom {
namespace {

Error fault(std::size_t line, std::string_view what) { return {Errc::kMalformed, fmt::format("{}: {}", line, what)}; }

/// Returns the position after the string that begins at `begin`; nullopt if its line ends first.
std::optional<std::size_t> end_of_string(std::string_view text, std::size_t begin) {
    const char quote = text[begin];
    for (std::size_t at = begin + 1; at < text.size() && text[at] != '\n'; ++at) {
        if (text[at] == quote) return at + 1;
        if (text[at] == '\\' && quote == '"') ++at;
    }
    return std::nullopt;
}

/// Returns whether the text at `at` may follow a string or an array.
bool is_separated(std::string_view text, std::size_t at) {
    const auto next = text.find_first_not_of(" \t\r", at);
    return next == std::string_view::npos || std::string_view("\n#,]=").find(text[next]) != std::string_view::npos;
}

} // namespace

Result<std::string> one_line_a_setting(std::string_view toml) {
    std::string settings;
    std::size_t line = 1;
    std::vector<std::size_t> open; // line numbers of the brackets that are not closed yet
    for (std::size_t at = 0; at < toml.size();) {
        const char c = toml[at];
        std::size_t end = at + 1;
        if (c == '#') {
            at = std::min(toml.find('\n', at), toml.size());
            continue;
        }
        if (c == '"' || c == '\'') {
            const auto closed = end_of_string(toml, at);
            if (!closed) return fault(line, fmt::format("a string is not closed; end it with {}", c));
            end = *closed;
        }
        if (c == '[') open.push_back(line);
        if (c == ']') {
            if (open.empty()) return fault(line, "there is a ] without a [ before it; remove it");
            open.pop_back();
        }
        if ((c == '"' || c == '\'' || c == ']') && !is_separated(toml, end)) {
            return fault(line, fmt::format("there is more behind the {}; put one value, or a comma between two", c));
        }
        if (c == '\n') ++line;
        settings += c == '\n' && !open.empty() ? " " : toml.substr(at, end - at);
        at = end;
    }
    if (!open.empty()) return fault(open.front(), "a [ is not closed; end it with ]");
    return settings;
}

Result<std::string> read_config_text(std::istream& input) {
    std::string text(kConfigBytesMax + 1, '\0');
    input.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(input.gcount()));
    if (text.size() <= kConfigBytesMax) return text;
    return Error{Errc::kFull, fmt::format("it has more than {} bytes; name a file of settings", kConfigBytesMax)};
}

} // namespace scanloom
