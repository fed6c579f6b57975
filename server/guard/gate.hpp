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

/// Not let in: why, for the log and for whoever is refused.
struct Denied {
    access::Reason reason = access::Reason::kNoToken;
    std::string token; ///< its name; empty: not known
    Error error;
};

template <class T>
using Admitted = boost::system::result<T, Denied>;

[[noreturn]] inline void throw_exception_from_error(const Denied& denied, const boost::source_location&) {
    throw ErrorException(denied.error);
}

/// The tokens in force, and who was let in with them.
///
/// Without tokens everybody is let in, as access::anybody().
/// Thread  any; no call waits for anything but another one.
class Gate {
public:
    Gate();
    explicit Gate(access::TokenSet tokens);

    [[nodiscard]] bool is_open() const;

    /// The token of the secret.
    [[nodiscard]] Admitted<access::TokenRef> admit(std::string_view secret) const;

    /// The same by the secret's hash; null when it is not in force.
    [[nodiscard]] access::TokenRef find_hash(std::string_view hash) const;

    /// Lets the robot of this name have a link to the session, which need not exist. Until the pass is gone, it counts
    /// as one of the token's connections; several of one robot, of which the session keeps the newest, count once.
    [[nodiscard]] Admitted<std::shared_ptr<Pass>> let_drive(std::string_view secret, const std::string& session,
                                                            const std::string& robot);

    /// Lets somebody who was admitted watch the session.
    [[nodiscard]] Admitted<std::shared_ptr<Pass>> let_watch(const access::TokenRef& token, const std::string& session);

    /// From now on these are in force. Passes that they do not allow end; the others go on with the token's new limits.
    void replace(access::TokenSet tokens);

private:
    struct Ledger;

    const std::shared_ptr<Ledger> ledger_; // outlives the passes
};

} // namespace scanloom::guard
