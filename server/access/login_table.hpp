#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::access {

/// Browsers that are signed in: of each only a hash of what its cookie holds, and whose token it was signed in with.
/// The token's secret is in neither.
///
/// Bounds  kLoginsMax; of one token kLoginsOfTokenMax. One more, and the one that was used longest ago is forgotten.
/// Times   seconds of a clock that is never put back.
class LoginTable {
public:
    static constexpr std::size_t kLoginsMax = 4096;
    static constexpr std::size_t kLoginsOfTokenMax = 64;
    static constexpr double kIdleSeconds = 12.0 * 3600.0; ///< unused for so long, it is over

    /// `cookie` is a new secret_of() random bits.
    void open(std::string_view cookie, const std::string& token_hash, double now);

    /// The hash of the token that was signed in with; nothing when it is over.
    [[nodiscard]] std::optional<std::string> use(std::string_view cookie, double now);

    void close(std::string_view cookie);

    [[nodiscard]] std::size_t size() const noexcept { return logins_.size(); }

private:
    struct Login {
        std::string token_hash;
        double used = 0.0;
    };

    void make_room(const std::string& token_hash, double now);

    std::map<std::string, Login, std::less<>> logins_; // by the cookie's hash
};

} // namespace scanloom::access
