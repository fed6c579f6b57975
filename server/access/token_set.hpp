#pragma once

#include "server/access/token.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::access {

/// The tokens that are in force. Immutable.
class TokenSet {
public:
    TokenSet() = default;

    /// Pre: all names and all hashes differ, and each hash is_hash().
    explicit TokenSet(std::vector<TokenRef> tokens) : tokens_(std::move(tokens)) {}

    /// The token of the secret; null when there is none.
    /// Cost  that of one hash and of one comparison with every token, the same whatever is sent: how long it takes
    ///       tells nothing.
    [[nodiscard]] TokenRef find(std::string_view secret) const;

    /// The same by hash_of() the secret.
    [[nodiscard]] TokenRef find_hash(std::string_view hash) const;

    [[nodiscard]] const std::vector<TokenRef>& tokens() const noexcept { return tokens_; }

private:
    std::vector<TokenRef> tokens_;
};

} // namespace scanloom::access
