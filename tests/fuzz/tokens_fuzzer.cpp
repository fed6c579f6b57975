#include "server/auth/token.hpp"
#include "server/auth/token_text.hpp"
#include "tests/fuzz/check.hpp"

#include <cctype>
#include <cstdint>
#include <string>

/// Input: the file of --tokens.
SCANLOOM_FUZZER(tokens)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    static_cast<void>(auth::without_secrets(text));
    const auto tokens = auth::parse_tokens(text);
    if (!tokens) {
        const auto& message = tokens.error().message;
        fuzz::check(!message.empty() && std::isdigit(static_cast<unsigned char>(message[0])) != 0,
                    "every error begins with its line");
        return 0;
    }
    std::string again;
    for (const auto& token : tokens->tokens()) {
        fuzz::check(auth::is_hash(token->hash), "only hashes are accepted");
        for (const auto& pattern : token->sessions) {
            fuzz::check(auth::is_valid_pattern(pattern), "only patterns are accepted");
            static_cast<void>(auth::matches(pattern, token->name));
        }
        again += auth::text_of(*token);
    }
    const auto reread = auth::parse_tokens(again);
    fuzz::check(reread.has_value() && reread->tokens().size() == tokens->tokens().size(), "a written file can be read");
    return 0;
}
