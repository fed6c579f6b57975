#include "server/access/token_set.hpp"

#include "server/access/secret.hpp"

#include <openssl/crypto.h>

namespace scanloom::access {

TokenRef TokenSet::find(std::string_view secret) const { return find_hash(hash_of(secret)); }

TokenRef TokenSet::find_hash(std::string_view hash) const {
    const Token* found = nullptr;
    std::size_t index = 0;
    for (std::size_t n = 0; n < tokens_.size(); ++n) {
        const Token& token = *tokens_[n];
        const bool same =
            token.hash.size() == hash.size() && CRYPTO_memcmp(token.hash.data(), hash.data(), hash.size()) == 0;
        found = same ? &token : found;
        index = same ? n : index;
    }
    return found == nullptr ? nullptr : tokens_[index];
}

} // namespace scanloom::access
