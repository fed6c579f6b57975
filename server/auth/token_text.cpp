#include "server/auth/token_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

namespace scanloom::auth {

/// Thrown where an assertion of toml++ fails.
struct ParserIsAstray {};
[[noreturn]] void give_up_parsing() { throw ParserIsAstray(); }

} // namespace scanloom::auth

// Some assertions of toml++ 3.3 fail for malformed files (its pull request 301 fixes one such place), and without
// assertions it relies on their conditions. Therefore they are enabled in this file only, and a failed one ends the
// parsing.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_EXCEPTIONS 0
#define TOML_ASSERT(expression) (static_cast<bool>(expression) ? void() : ::scanloom::auth::give_up_parsing())
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace scanloom::auth {
namespace {

constexpr std::array<std::string_view, 5> kKeys = {"name", "sha256", "role", "sessions", "limits"};
constexpr std::size_t kTokensMax = 10'000;
constexpr std::size_t kPatternsMax = 256;

/// The key and upper bound of a limit that is a whole number.
struct Count {
    std::string_view key;
    std::size_t Limits::*limit;
    std::size_t most;
};

constexpr std::array kCounts = {
    Count{"connections", &Limits::connections, 1'000'000}, Count{"sessions", &Limits::sessions, 1'000'000},
    Count{"sensors", &Limits::sensors, kSensorsMax},       Count{"beams", &Limits::beams, kBeamsMax},
    Count{"cells", &Limits::cells, std::size_t{1} << 40},
};
constexpr std::string_view kRate = "bytes_per_second";
constexpr double kRateMax = 1e12;

Error fault(const toml::source_region& where, std::string_view what, Errc code = Errc::kInvalidField) {
    return {code, fmt::format("{}: {}", where.begin.line, what)};
}

/// Returns where a comment begins in the line, or the line's length. Multi-line strings are not supported.
std::size_t comment_in(std::string_view line) {
    char quote = '\0';
    for (std::size_t at = 0; at < line.size(); ++at) {
        const char c = line[at];
        if (quote == '"' && c == '\\') {
            ++at;
        } else if (quote != '\0') {
            if (c == quote) quote = '\0';
        } else if (c == '#') {
            return at;
        } else if (c == '"' || c == '\'') {
            quote = c;
        }
    }
    return line.size();
}

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

/// Returns the text without non-ASCII characters, because some of them lead toml++ 3.3 to undefined behaviour (its
/// issues 190 and 295). They are allowed in comments only, and replaced there.
Result<std::string> fit_for_parser(std::string_view toml) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF"; // some editors write it
    if (toml.starts_with(kByteOrderMark)) toml.remove_prefix(kByteOrderMark.size());
    std::string fit;
    for (std::size_t number = 1; !toml.empty(); ++number) {
        const auto end = std::min(toml.find('\n'), toml.size());
        std::string line(toml.substr(0, end));
        const auto comment = line.begin() + static_cast<std::ptrdiff_t>(comment_in(line));
        if (!std::all_of(line.begin(), comment, is_ascii)) {
            return Error{Errc::kMalformed, // without the line itself: it may contain a secret
                         fmt::format("{}: there are letters beyond ASCII, which only comments may have", number)};
        }
        std::replace_if(comment, line.end(), std::not_fn(is_ascii), '?');
        fit += line += '\n';
        toml.remove_prefix(std::min(end + 1, toml.size()));
    }
    return fit;
}

/// Returns text of the file in quotes, shortened and printable, for a message.
std::string shown(std::string_view text) {
    constexpr std::size_t kShown = 64;
    std::string result = "'";
    for (const char c : text.substr(0, kShown)) result += c >= ' ' && c <= '~' ? c : '?';
    return result + (text.size() > kShown ? "...'" : "'");
}

Result<std::string> text_in(const toml::table& table, std::string_view key) {
    const auto* node = table.get(key);
    if (node == nullptr) return fault(table.source(), fmt::format("{} is missing in this [[token]]; add it", key));
    const auto text = node->value_exact<std::string>();
    if (!text) return fault(node->source(), fmt::format("{} is not a text; write {} = \"...\"", key, key));
    return *text;
}

Result<> read_name(const toml::table& table, Token& token) {
    auto name = text_in(table, "name");
    if (!name) return name.error();
    token.name = std::move(*name);
    if (is_valid_name(token.name)) return {};
    return fault(table.get("name")->source(), fmt::format("name is {}; use 1 to {} characters of A-Z a-z 0-9 _ -",
                                                          shown(token.name), kNameBytesMax));
}

Result<> read_hash(const toml::table& table, Token& token) {
    auto hash = text_in(table, "sha256");
    if (!hash) return hash.error();
    token.hash = std::move(*hash);
    if (is_hash(token.hash)) return {};
    return fault(table.get("sha256")->source(), // not shown: it may be the secret itself
                 "sha256 is not 64 digits of 0-9 a-f; `scanloom-server token` makes a secret and prints this line");
}

Result<> read_role(const toml::table& table, Token& token) {
    const auto name = text_in(table, "role");
    if (!name) return name.error();
    const auto role = role_of(*name);
    if (!role) {
        return fault(table.get("role")->source(),
                     fmt::format("role is {}; use robot, viewer or operator", shown(*name)));
    }
    token.role = *role;
    return {};
}

Result<> read_sessions(const toml::table& table, Token& token) {
    const auto* node = table.get("sessions");
    if (node == nullptr) {
        return fault(table.source(),
                     "sessions is missing in this [[token]]; add sessions = [\"*\"], or patterns of its sessions");
    }
    const auto* patterns = node->as_array();
    if (patterns == nullptr || patterns->empty() || patterns->size() > kPatternsMax) {
        return fault(
            node->source(),
            fmt::format(
                "sessions is no list of 1 to {} patterns; write sessions = [\"*\"], or patterns of its sessions",
                kPatternsMax));
    }
    for (const auto& element : *patterns) {
        auto pattern = element.value_exact<std::string>();
        if (!pattern || !is_valid_pattern(*pattern)) {
            return fault(element.source(),
                         fmt::format("{} is no pattern of sessions; use 1 to {} characters of A-Z a-z 0-9 _ - * ?",
                                     shown(pattern.value_or("that")), kNameBytesMax));
        }
        token.sessions.push_back(std::move(*pattern));
    }
    return {};
}

Result<> read_limit(std::string_view key, const toml::node& node, Limits& limits) {
    if (key == kRate) {
        const auto rate = node.value<double>();
        if (!rate || !(*rate >= kBytesPerSecondMin && *rate <= kRateMax)) {
            return fault(node.source(),
                         fmt::format("{} is not a number from {} to {}", key, kBytesPerSecondMin, kRateMax));
        }
        limits.bytes_per_second = *rate;
        return {};
    }
    const auto count = std::ranges::find(kCounts, key, &Count::key);
    if (count == kCounts.end()) {
        return fault(node.source(), fmt::format("{} is no limit; possible are {}, connections, sessions, sensors, "
                                                "beams, cells",
                                                shown(key), kRate));
    }
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < 1 || static_cast<std::size_t>(*value) > count->most) {
        return fault(node.source(), fmt::format("{} is not a whole number from 1 to {}", key, count->most));
    }
    limits.*(count->limit) = static_cast<std::size_t>(*value);
    return {};
}

Result<> read_limits(const toml::table& table, Token& token) {
    const auto* node = table.get("limits");
    if (node == nullptr) return {};
    const auto* limits = node->as_table();
    if (limits == nullptr) return fault(node->source(), "limits is no table; write limits = { connections = 8 }");
    for (const auto& [key, value] : *limits) {
        if (auto read = read_limit(key.str(), value, token.limits); !read) return read.error();
    }
    return {};
}

Result<Token> read_token(const toml::table& table) {
    for (const auto& [key, value] : table) {
        if (std::ranges::find(kKeys, key.str()) != kKeys.end()) continue;
        return fault(key.source(), fmt::format("{} is unknown in a [[token]]; possible are {}", shown(key.str()),
                                               fmt::join(kKeys, ", ")));
    }
    Token token;
    for (const auto read : {read_name, read_hash, read_role, read_sessions, read_limits}) {
        if (auto done = read(table, token); !done) return done.error();
    }
    return token;
}

/// Names must differ because logs identify a token by its name; hashes, because clients are identified by their secret.
Result<> check_different(const toml::table& table, const Token& token, const std::vector<TokenRef>& others) {
    for (const auto& other : others) {
        if (other->name == token.name) {
            return fault(table.source(), fmt::format("there is a token of the name {} already; choose another name",
                                                     shown(token.name)));
        }
        if (other->hash == token.hash) {
            return fault(table.source(), fmt::format("{} and {} have the same secret; make another with "
                                                     "`scanloom-server token`",
                                                     shown(other->name), shown(token.name)));
        }
    }
    return {};
}

Result<TokenSet> tokens_in(const toml::array& tables) {
    if (tables.size() > kTokensMax) {
        return fault(tables.source(),
                     fmt::format("there are {} tokens, at most {} are read", tables.size(), kTokensMax));
    }
    std::vector<TokenRef> tokens;
    for (const auto& node : tables) {
        const auto* table = node.as_table();
        if (table == nullptr) return fault(node.source(), "this is no [[token]]; give each a table of its own");
        auto token = read_token(*table);
        if (!token) return token.error();
        if (auto different = check_different(*table, *token, tokens); !different) return different.error();
        tokens.push_back(std::make_shared<const Token>(std::move(*token)));
    }
    return TokenSet(std::move(tokens));
}

Result<toml::table> parsed_by_library(std::string_view text) {
    try {
        auto parsed = toml::parse(text);
        if (parsed) return std::move(parsed).table();
        return fault(parsed.error().source(), fmt::format("this is no TOML: {}", parsed.error().description()),
                     Errc::kMalformed);
    } catch (const ParserIsAstray&) {
        return Error{Errc::kMalformed, "1: this is no TOML: there is a bracket or a quote too many somewhere in it"};
    }
}

} // namespace

Result<TokenSet> parse_tokens(std::string_view toml) {
    const auto fit = fit_for_parser(toml);
    if (!fit) return fit.error();
    const auto parsed = parsed_by_library(*fit);
    if (!parsed) return parsed.error();
    const toml::table& root = *parsed;
    for (const auto& [key, value] : root) {
        if (key.str() == "token" && value.is_array()) continue;
        return fault(key.source(), fmt::format("{} is unknown here; the file holds tokens, each below a line [[token]]",
                                               shown(key.str())));
    }
    const auto* tables = root.get_as<toml::array>("token");
    if (tables == nullptr || tables->empty()) { // probably a mistake
        return Error{Errc::kInvalidField, "1: there is no [[token]] in it; `scanloom-server token` prints one to add"};
    }
    return tokens_in(*tables);
}

std::string text_of(const Token& token) {
    auto text = fmt::format("[[token]]\nname = \"{}\"\nsha256 = \"{}\"\nrole = \"{}\"\nsessions = [\"{}\"]\n",
                            token.name, token.hash, name_of(token.role), fmt::join(token.sessions, "\", \""));
    const Limits usual;
    std::vector<std::string> limits;
    for (const auto& count : kCounts) {
        const auto limit = token.limits.*(count.limit);
        if (limit != usual.*(count.limit)) limits.push_back(fmt::format("{} = {}", count.key, limit));
    }
    if (token.limits.bytes_per_second != usual.bytes_per_second)
        limits.push_back(fmt::format("{} = {}", kRate, token.limits.bytes_per_second));
    if (!limits.empty()) text += fmt::format("limits = {{ {} }}\n", fmt::join(limits, ", "));
    return text;
}

} // namespace scanloom::auth
