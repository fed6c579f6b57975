#pragma once

#include "common/scan/limits.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Tokens: the roles that they permit, the limits and the sessions that they are for.
namespace scanloom::auth {

// Roles

/// The set of actions that a token permits.
enum class Role {
    kRobot,    ///< on robot links: sends scans, creates its sessions; over HTTP: requests goals
    kViewer,   ///< over HTTP: reads, and plans paths, which changes nothing
    kOperator, ///< everything that robots and viewers may do; also creates, imports and deletes
};

inline constexpr std::array kRoles = {Role::kRobot, Role::kViewer, Role::kOperator};

/// Returns the name in token files: "robot", "viewer" or "operator".
[[nodiscard]] constexpr std::string_view name_of(Role role) noexcept {
    switch (role) {
    case Role::kRobot: return "robot";
    case Role::kViewer: return "viewer";
    case Role::kOperator: return "operator";
    }
    return "unknown";
}

/// Returns the role of that name, or nullopt if there is none.
[[nodiscard]] constexpr std::optional<Role> role_of(std::string_view name) noexcept {
    for (const Role role : kRoles) {
        if (name_of(role) == name) return role;
    }
    return std::nullopt;
}

/// Returns whether the role permits robot links.
[[nodiscard]] constexpr bool may_drive(Role role) noexcept { return role != Role::kViewer; }

/// Returns whether the role permits HTTP requests that change nothing.
[[nodiscard]] constexpr bool may_look(Role role) noexcept { return role != Role::kRobot; }

/// Returns whether the role permits assigning goals to robots over HTTP.
[[nodiscard]] constexpr bool may_guide(Role role) noexcept { return role != Role::kViewer; }

/// Returns whether the role permits HTTP requests that change something.
[[nodiscard]] constexpr bool may_change(Role role) noexcept { return role == Role::kOperator; }

// Limits

/// The limits of one token. The server's own bounds apply in addition.
struct Limits {
    std::size_t connections = 64;               ///< robots connected at once
    double bytes_per_second = 16.0 * (1 << 20); ///< read from each link; the server reads later bytes after a pause
    std::size_t sessions = 256;                 ///< existing sessions that were created with the token
    std::size_t sensors = kSensorsMax;          ///< of one robot
    std::size_t beams = kBeamsMax;              ///< of one scan
    std::size_t cells = std::numeric_limits<std::size_t>::max(); ///< of the maps of one session created with the token

    friend bool operator==(const Limits&, const Limits&) = default;
};

/// The smallest `bytes_per_second` that a token file may have.
inline constexpr double kBytesPerSecondMin = 1024.0;

/// Returns the limits that apply if the server has no tokens: only those of the protocol.
[[nodiscard]] constexpr Limits no_limits() noexcept {
    Limits limits;
    limits.connections = limits.sessions = std::numeric_limits<std::size_t>::max();
    limits.bytes_per_second = std::numeric_limits<double>::infinity();
    return limits;
}

// Patterns of session names: '*' matches any text, including the empty text, '?' matches one character, and any other
// character matches itself.

/// Returns whether the pattern has 1 to 64 characters of A-Z a-z 0-9 _ - * ?
[[nodiscard]] bool is_valid_pattern(std::string_view pattern) noexcept;

/// Returns whether the whole name matches the pattern.
/// @param pattern  any text; is_valid_pattern() is not required
/// Cost: at most the product of the two lengths, for every pattern.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name) noexcept;

// Tokens

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
[[nodiscard]] const TokenRef& default_token();

} // namespace scanloom::auth
