#pragma once

#include "server/access/limits.hpp"
#include "server/access/role.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::access {

/// Who holds the secret may do this. The secret itself is not here: the server never keeps it.
struct Token {
    std::string name; ///< for logs and for what was made with it: [A-Za-z0-9_-]{1,64}
    std::string hash; ///< hash_of() the secret
    Role role = Role::kViewer;
    std::vector<std::string> sessions; ///< patterns of their names
    Limits limits;

    friend bool operator==(const Token&, const Token&) = default;
};

using TokenRef = std::shared_ptr<const Token>;

/// Whether one of its patterns matches the name.
[[nodiscard]] bool is_for(const Token& token, std::string_view session) noexcept;

/// Whether it is for every session, also for what concerns all of them.
[[nodiscard]] bool is_for_all(const Token& token) noexcept;

/// Whoever comes where nothing is guarded: an operator of everything, without a name.
[[nodiscard]] const TokenRef& anybody();

} // namespace scanloom::access
