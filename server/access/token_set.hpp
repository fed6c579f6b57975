#pragma once

#include "server/access/token.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::access {

/// An immutable set of tokens.
class TokenSet {
public:
    TokenSet() = default;

    /// Pre: all names differ, all hashes differ, and each hash satisfies is_hash().
    explicit TokenSet(std::vector<TokenRef> tokens) : tokens_(std::move(tokens)) {}

    /// Finds the token of the secret.
    /// @return null if there is none
    /// Cost: one hash, and one comparison with every token. The time does not depend on the secret and so reveals
    ///       nothing.
    [[nodiscard]] TokenRef find(std::string_view secret) const;

    /// Finds the token by hash_of() its secret.
    /// @return null if there is none
    [[nodiscard]] TokenRef find_hash(std::string_view hash) const;

    [[nodiscard]] const std::vector<TokenRef>& tokens() const noexcept { return tokens_; }

private:
    std::vector<TokenRef> tokens_;
};

} // namespace scanloom::access
