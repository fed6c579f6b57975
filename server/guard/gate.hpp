#pragma once

#include "common/error/error.hpp"
#include "server/access/refusal.hpp"
#include "server/access/token_set.hpp"
#include "server/guard/pass.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace scanloom::guard {

/// Why a client was refused: the reason and token for the log, the error for the client.
struct Denied {
    access::Reason reason = access::Reason::kNoToken;
    std::string token; ///< the token's name; empty: not known
    Error error;
};

template <class T>
using Admitted = boost::system::result<T, Denied>;

[[noreturn]] inline void throw_exception_from_error(const Denied& denied, const boost::source_location&) {
    throw ErrorException(denied.error);
}

/// Authenticates clients by their tokens, and grants passes for robot links and live viewers.
///
/// Without tokens every client is admitted, with the token access::anybody().
/// Threads: any thread; calls wait only for each other.
class Gate {
public:
    /// Creates a gate without tokens.
    Gate();

    /// Creates a gate with tokens; an empty set admits no client.
    explicit Gate(access::TokenSet tokens);

    /// Returns whether the server has no tokens, so that every client is admitted.
    [[nodiscard]] bool is_open() const;

    /// Returns the token of the secret.
    /// Errors: kNoToken if the secret is empty; kUnknownToken if its token is not in force.
    [[nodiscard]] Admitted<access::TokenRef> admit(std::string_view secret) const;

    /// Returns the token by its secret's hash, or null if it is not in force.
    [[nodiscard]] access::TokenRef find_hash(std::string_view hash) const;

    /// Permits the robot a link to the session, which need not exist.
    ///
    /// The pass counts as one of the token's connections until it is destroyed. Several passes for one robot in one
    /// session count once, because the session keeps only the robot's newest link.
    /// Errors: those of admit(); kWrongRole or kWrongSession if the token does not permit it; kLimit if the token's
    ///         `connections` are used up.
    [[nodiscard]] Admitted<std::shared_ptr<Pass>> let_drive(std::string_view secret, const std::string& session,
                                                            const std::string& robot);

    /// Permits an admitted client to watch the session.
    /// Errors: kUnknownToken if the token is no longer in force; kWrongRole or kWrongSession if it does not permit it.
    [[nodiscard]] Admitted<std::shared_ptr<Pass>> let_watch(const access::TokenRef& token, const std::string& session);

    /// Replaces the tokens in force. Passes that the new tokens do not permit end; the other passes get their token's
    /// new limits.
    void replace(access::TokenSet tokens);

private:
    struct Ledger;

    const std::shared_ptr<Ledger> ledger_; // outlives the passes
};

} // namespace scanloom::guard
