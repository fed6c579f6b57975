#pragma once

#include "server/access/token.hpp"

#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace scanloom::guard {

/// What a pass permits.
enum class Purpose {
    kDrive, ///< a robot's link
    kWatch, ///< a live viewer
};

/// Permission to use a session while the tokens in force allow it. Granted by Gate.
/// Threads: any thread.
class Pass {
public:
    Pass(access::TokenRef token, Purpose purpose, std::string session, std::string user)
        : purpose_(purpose), session_(std::move(session)), user_(std::move(user)), hash_(token->hash),
          token_(std::move(token)) {}

    /// Returns the token as it is in force now, or null if it no longer permits this use.
    [[nodiscard]] access::TokenRef token() const;

    /// Sets the callback for changes of token(). It is called from any thread after each replacement of the tokens, and
    /// at once if one has happened already.
    void when_changed(const std::function<void()>& told);

    [[nodiscard]] Purpose purpose() const noexcept { return purpose_; }
    [[nodiscard]] const std::string& session() const noexcept { return session_; }
    [[nodiscard]] const std::string& user() const noexcept { return user_; }
    [[nodiscard]] const std::string& hash() const noexcept { return hash_; }

    /// Sets the token and calls the callback. Only for Gate.
    void change(access::TokenRef token);

private:
    const Purpose purpose_;
    const std::string session_;
    const std::string user_; // distinguishes the robots of one token
    const std::string hash_;

    mutable std::mutex mutex_; // guards the following members; held only to copy them
    access::TokenRef token_;
    bool changed_ = false;
    std::function<void()> told_;
};

} // namespace scanloom::guard
