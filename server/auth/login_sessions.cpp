#include "server/auth/login_sessions.hpp"

#include "server/auth/login_cookie.hpp"
#include "server/auth/token.hpp"

#include <algorithm>
#include <chrono>

namespace scanloom::auth {

void LoginTable::open(std::string_view cookie, const std::string& token_hash, double now) {
    make_room(token_hash, now);
    logins_[hash_of(cookie)] = {token_hash, now};
}

std::optional<std::string> LoginTable::use(std::string_view cookie, double now) {
    const auto login = logins_.find(hash_of(cookie));
    if (login == logins_.end()) return std::nullopt;
    if (now - login->second.used > kIdleSeconds) {
        logins_.erase(login);
        return std::nullopt;
    }
    login->second.used = now;
    return login->second.token_hash;
}

void LoginTable::close(std::string_view cookie) { logins_.erase(hash_of(cookie)); }

void LoginTable::make_room(const std::string& token_hash, double now) {
    std::erase_if(logins_, [&](const auto& login) { return now - login.second.used > kIdleSeconds; });
    std::size_t of_token = 0;
    auto oldest = logins_.end();
    auto oldest_of_token = logins_.end();
    for (auto login = logins_.begin(); login != logins_.end(); ++login) {
        const auto is_older = [&](auto than) {
            return than == logins_.end() || login->second.used < than->second.used;
        };
        if (is_older(oldest)) oldest = login;
        if (login->second.token_hash != token_hash) continue;
        ++of_token;
        if (is_older(oldest_of_token)) oldest_of_token = login;
    }
    if (of_token >= kLoginsOfTokenMax) {
        logins_.erase(oldest_of_token);
    } else if (logins_.size() >= kLoginsMax) {
        logins_.erase(oldest);
    }
}

double unix_seconds() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string LoginSessions::open(const Token& token) {
    auto cookie = random_secret();
    if (!secret_.empty()) cookie = signed_cookie(cookie, token.hash, date_(), secret_);
    const std::lock_guard lock(mutex_);
    table_.open(cookie, token.hash, now_());
    return cookie;
}

TokenRef LoginSessions::find(std::string_view cookie, const Authenticator& authenticator) {
    std::optional<std::string> hash;
    {
        const std::lock_guard lock(mutex_);
        const double now = now_();
        hash = table_.use(cookie, now);
        if (!hash && !secret_.empty()) {
            adopt(cookie, now);
            hash = table_.use(cookie, now);
        }
    }
    return hash ? authenticator.find_hash(*hash) : nullptr;
}

void LoginSessions::close(std::string_view cookie) {
    const std::lock_guard lock(mutex_);
    table_.close(cookie);
    if (secret_.empty() || !token_hash_in(cookie, date_(), LoginTable::kIdleSeconds, secret_)) return;
    const double now = now_();
    std::erase_if(closed_, [&](const auto& one) { return now - one.second > LoginTable::kIdleSeconds; });
    if (closed_.size() >= LoginTable::kLoginsMax) {
        closed_.erase(std::ranges::min_element(closed_, {}, [](const auto& one) { return one.second; }));
    }
    closed_[hash_of(cookie)] = now;
}

/// Opens a login that another server has made.
void LoginSessions::adopt(std::string_view cookie, double now) {
    if (closed_.contains(hash_of(cookie))) return;
    const auto token_hash = token_hash_in(cookie, date_(), LoginTable::kIdleSeconds, secret_);
    if (token_hash) table_.open(cookie, *token_hash, now);
}

} // namespace scanloom::auth
