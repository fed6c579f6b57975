#include "server/auth/authenticator.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::auth {

TokenRef Credential::token() const {
    const std::lock_guard lock(mutex_);
    return token_;
}

void Credential::when_changed(const std::function<void()>& on_change) {
    bool has_changed = false;
    {
        const std::lock_guard lock(mutex_);
        on_change_ = on_change;
        has_changed = changed_;
    }
    if (has_changed) on_change();
}

void Credential::change(TokenRef token) {
    std::function<void()> on_change;
    {
        const std::lock_guard lock(mutex_);
        token_ = std::move(token);
        changed_ = true;
        on_change = on_change_;
    }
    if (on_change) on_change();
}

namespace {

Denied denied(Reason reason, const TokenRef& token, std::string message, Errc code = Errc::kUnauthorized) {
    return {reason, token ? token->name : std::string(), {code, std::move(message)}};
}

Denied unknown(std::string_view secret) {
    if (secret.empty())
        return denied(Reason::kNoToken, nullptr,
                      "a token is needed and none was sent; ask the operator of this server for one");
    return denied(Reason::kUnknownToken, nullptr,
                  "the token that was sent is not valid here; ask the operator of this server for one");
}

TokenRef found(const std::shared_ptr<const TokenSet>& tokens, std::string_view hash) {
    return tokens ? tokens->find_hash(hash) : default_token();
}

} // namespace

struct Authenticator::Ledger : std::enable_shared_from_this<Authenticator::Ledger> {
    /// The connected robots of one token, with their number of links: a robot that reconnects has two for a short time.
    using Robots = std::map<std::string, std::size_t>;

    mutable std::mutex mutex;
    std::shared_ptr<const TokenSet> tokens;                         // null: every client is admitted
    std::map<std::uint64_t, std::weak_ptr<Credential>> credentials; // in the order in which they were granted
    std::uint64_t last_credential = 0;
    std::map<std::string, Robots, std::less<>> connected; // by the token's hash

    std::shared_ptr<const TokenSet> in_force() const {
        const std::lock_guard lock(mutex);
        return tokens;
    }

    std::optional<Denied> connection_limit_of(const TokenRef& token, const std::string& robot) const {
        const auto known = connected.find(token->hash);
        if (known == connected.end() || known->second.contains(robot)) return std::nullopt;
        const auto limit = token->limits.connections;
        if (known->second.size() < limit) return std::nullopt;
        return denied(Reason::kLimit, token,
                      fmt::format("{} robots are connected with the token '{}', the most that its limit `connections` "
                                  "allows; disconnect one, or raise the limit",
                                  limit, token->name),
                      Errc::kOverloaded);
    }

    /// Deletes a credential, and removes it from the ledger if it was granted.
    struct Deleter {
        std::shared_ptr<Ledger> ledger; // null until the credential is granted
        std::uint64_t number = 0;       // its key in `credentials`

        void operator()(Credential* credential) const {
            if (ledger) ledger->forget(number, *credential);
            delete credential;
        }
    };

    /// Grants a credential. Its destruction locks `mutex`.
    /// Pre: `mutex` is locked.
    /// Errors: throws std::bad_alloc; nothing is granted then.
    std::shared_ptr<Credential> give(const TokenRef& token, Action action, const std::string& session,
                                     const std::string& user) {
        std::shared_ptr<Credential> credential(new Credential(token, action, session, user), Deleter{});
        decltype(credentials) entry;
        entry.emplace(++last_credential, credential);
        if (action == Action::kDrive) ++connected[token->hash][user];
        // From here on nothing throws.
        credentials.merge(entry);
        *std::get_deleter<Deleter>(credential) = {shared_from_this(), last_credential};
        return credential;
    }

    void forget(std::uint64_t number, const Credential& credential) {
        const std::lock_guard lock(mutex);
        credentials.erase(number);
        if (credential.action() != Action::kDrive) return;
        auto& robots = connected[credential.hash()];
        if (--robots[credential.user()] == 0) robots.erase(credential.user());
        if (robots.empty()) connected.erase(credential.hash());
    }
};

Authenticator::Authenticator() : ledger_(std::make_shared<Ledger>()) {}

Authenticator::Authenticator(TokenSet tokens) : Authenticator() { replace(std::move(tokens)); }

bool Authenticator::is_open() const { return ledger_->in_force() == nullptr; }

Admitted<TokenRef> Authenticator::admit(std::string_view secret) const {
    const auto tokens = ledger_->in_force(); // hashing needs no lock
    if (auto token = tokens ? tokens->find(secret) : default_token()) return token;
    return unknown(secret);
}

TokenRef Authenticator::find_hash(std::string_view hash) const { return found(ledger_->in_force(), hash); }

Admitted<std::shared_ptr<Credential>>
Authenticator::grant_robot_link(std::string_view secret, const std::string& session, const std::string& robot) {
    const auto admitted = admit(secret);
    if (!admitted) return admitted.error();
    const std::lock_guard lock(ledger_->mutex);
    const auto token = found(ledger_->tokens, (*admitted)->hash); // the tokens may have been replaced meanwhile
    if (!token) return unknown(secret);
    if (auto permitted = check_permission(*token, Action::kDrive, session); !permitted) return permitted.error();
    const std::string user = session + "/" + robot;
    if (auto why = ledger_->connection_limit_of(token, user)) return *why;
    return ledger_->give(token, Action::kDrive, session, user);
}

Admitted<std::shared_ptr<Credential>> Authenticator::grant_viewing(const TokenRef& token, const std::string& session) {
    const std::lock_guard lock(ledger_->mutex);
    const auto now = found(ledger_->tokens, token->hash);
    if (!now) return unknown(token->hash); // default_token() has no hash: as if the client had sent no token
    if (auto permitted = check_permission(*now, Action::kRead, session); !permitted) return permitted.error();
    return ledger_->give(now, Action::kRead, session, "");
}

void Authenticator::replace(TokenSet tokens) {
    const auto replacement = std::make_shared<const TokenSet>(std::move(tokens));
    // `changes` holds each credential until the lock is released, because the destruction of a credential locks, too.
    std::vector<std::pair<std::shared_ptr<Credential>, TokenRef>> changes;
    {
        const std::lock_guard lock(ledger_->mutex);
        changes.reserve(ledger_->credentials.size());
        for (const auto& [number, weak] : ledger_->credentials) {
            auto& [credential, token] = changes.emplace_back(weak.lock(), nullptr);
            if (!credential) continue;
            token = found(replacement, credential->hash());
            if (token && !check_permission(*token, credential->action(), credential->session())) token = nullptr;
        }
        ledger_->tokens = replacement;
    }
    // Without the lock: the callback may call the authenticator.
    for (auto& [credential, token] : changes) {
        if (credential) credential->change(std::move(token));
    }
}

} // namespace scanloom::auth
