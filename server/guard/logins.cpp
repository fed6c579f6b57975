#include "server/guard/logins.hpp"

#include "server/guard/random_secret.hpp"

namespace scanloom::guard {

std::string Logins::open(const access::Token& token) {
    auto cookie = random_secret();
    const std::lock_guard lock(mutex_);
    table_.open(cookie, token.hash, now_());
    return cookie;
}

access::TokenRef Logins::find(std::string_view cookie, const Gate& gate) {
    std::optional<std::string> hash;
    {
        const std::lock_guard lock(mutex_);
        hash = table_.use(cookie, now_());
    }
    return hash ? gate.find_hash(*hash) : nullptr;
}

void Logins::close(std::string_view cookie) {
    const std::lock_guard lock(mutex_);
    table_.close(cookie);
}

} // namespace scanloom::guard
