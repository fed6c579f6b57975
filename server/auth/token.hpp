#pragma once

#include "common/error/error.hpp"
#include "common/scan/limits.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Tokens: their secrets, the roles that they permit, the limits and the sessions that they are for.
namespace scanloom::auth {

// Secrets: the text by which a client proves that it holds a token

/// Returns "scanloom_" and 64 hexadecimal digits.
///
/// A secret is longer than any valid name, so it cannot be mistaken for a session or robot name. The prefix makes
/// secrets recognizable, so that logs can be cleaned of them and secret scanners find them in repositories.
/// @param random  256 unpredictable bits
[[nodiscard]] std::string secret_of(const std::array<std::byte, 32>& random);

/// Returns the SHA-256 of the secret as 64 lower-case hexadecimal digits. A slow password hash would add no protection,
/// because 256 random bits cannot be guessed from a dictionary.
[[nodiscard]] std::string hash_of(std::string_view secret);

/// Returns whether the text has the form that hash_of() returns.
[[nodiscard]] bool is_hash(std::string_view text) noexcept;

/// Returns the text with every secret, even a truncated one, replaced by "scanloom_...". For logs, because clients may
/// send a secret in a field that is logged.
[[nodiscard]] std::string without_secrets(std::string_view text);

/// Creates a secret from 256 random bits of the system.
/// Errors: std::runtime_error if the system has none.
[[nodiscard]] std::string random_secret();

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

/// What a role permits.
enum class Action {
    kDrive,  ///< robot links
    kRead,   ///< HTTP requests that change nothing, live viewers
    kGuide,  ///< assigning goals to robots over HTTP
    kChange, ///< HTTP requests that change something
};

/// Returns whether the role permits the action.
[[nodiscard]] constexpr bool permits(Role role, Action action) noexcept {
    switch (action) {
    case Action::kDrive:
    case Action::kGuide: return role != Role::kViewer;
    case Action::kRead: return role != Role::kRobot;
    case Action::kChange: return role == Role::kOperator;
    }
    return false;
}

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

// Refusals

/// Why a connection or a request is refused.
enum class Reason {
    kNoToken,            ///< no token was sent and one is required
    kUnknownToken,       ///< the token that was sent is not in force
    kWrongRole,          ///< the token's role does not permit the action
    kWrongSession,       ///< the token is not for that session
    kForeignPage,        ///< a page of another site sent the request from a browser that is signed in here
    kForeignHost,        ///< the request names a host that is not this server's, as in DNS rebinding
    kLimit,              ///< a limit of the token is reached
    kRevoked,            ///< the token in use no longer permits it
    kNoCertificate,      ///< no client certificate was sent and one is required
    kForeignCertificate, ///< the client certificate was not signed by the configured CA, or is not valid now
};

inline constexpr std::array kReasons = {
    Reason::kNoToken,       Reason::kUnknownToken,      Reason::kWrongRole, Reason::kWrongSession,
    Reason::kForeignPage,   Reason::kForeignHost,       Reason::kLimit,     Reason::kRevoked,
    Reason::kNoCertificate, Reason::kForeignCertificate};

[[nodiscard]] constexpr std::string_view name_of(Reason reason) noexcept {
    switch (reason) {
    case Reason::kNoToken: return "no_token";
    case Reason::kUnknownToken: return "unknown_token";
    case Reason::kWrongRole: return "wrong_role";
    case Reason::kWrongSession: return "wrong_session";
    case Reason::kForeignPage: return "foreign_page";
    case Reason::kForeignHost: return "foreign_host";
    case Reason::kLimit: return "limit";
    case Reason::kRevoked: return "revoked";
    case Reason::kNoCertificate: return "no_certificate";
    case Reason::kForeignCertificate: return "foreign_certificate";
    }
    return "unknown";
}

/// Why a client was refused: the reason and token for the log, the error for the client.
struct Denied {
    Reason reason = Reason::kNoToken;
    std::string token; ///< the token's name; empty: not known
    Error error;
};

template <class T>
using Admitted = boost::system::result<T, Denied>;

[[noreturn]] inline void throw_exception_from_error(const Denied& denied, const boost::source_location&) {
    throw ErrorException(denied.error);
}

/// Checks that the token permits an action.
/// @param session  name of the session that the action concerns; nullopt: none in particular
/// Errors: kWrongRole; kWrongSession.
[[nodiscard]] Admitted<void> check_permission(const Token& token, Action action,
                                              std::optional<std::string_view> session);

} // namespace scanloom::auth
