#pragma once

#include "server/access/limits.hpp"
#include "server/access/role.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::access {

/// What the holder of a secret is permitted to do. The secret itself is not stored: the server keeps only its hash.
struct Token {
    std::string name; ///< in logs and in sessions created with the token: [A-Za-z0-9_-]{1,64}
    std::string hash; ///< hash_of() the secret
    Role role = Role::kViewer;
    std::vector<std::string> sessions; ///< patterns of session names
    Limits limits;

    friend bool operator==(const Token&, const Token&) = default;
};

using TokenRef = std::shared_ptr<const Token>;

/// Returns whether one of the token's patterns matches the session's name.
[[nodiscard]] bool is_for(const Token& token, std::string_view session) noexcept;

/// Returns whether the token is for every session, and so for actions that concern all sessions.
[[nodiscard]] bool is_for_all(const Token& token) noexcept;

/// Returns the token that every client has if the server has no tokens: an operator for all sessions, without a name.
[[nodiscard]] const TokenRef& anybody();

} // namespace scanloom::access
