#pragma once

#include "server/access/token.hpp"

#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace scanloom::guard {

/// What a pass is for.
enum class Purpose {
    kDrive, ///< a robot's link
    kWatch, ///< a viewer, live
};

/// Leave to use a session for a while, for as long as the tokens in force allow it. Gate gives them out.
/// Thread  any.
class Pass {
public:
    Pass(access::TokenRef token, Purpose purpose, std::string session, std::string user)
        : purpose_(purpose), session_(std::move(session)), user_(std::move(user)), hash_(token->hash),
          token_(std::move(token)) {}

    /// The token as it is in force now; null when it allows this no more.
    [[nodiscard]] access::TokenRef token() const;

    /// From now on `told` is called, from any thread, when token() has become another; at once when it has already.
    void when_changed(const std::function<void()>& told);

    [[nodiscard]] Purpose purpose() const noexcept { return purpose_; }
    [[nodiscard]] const std::string& session() const noexcept { return session_; }
    [[nodiscard]] const std::string& user() const noexcept { return user_; }
    [[nodiscard]] const std::string& hash() const noexcept { return hash_; }

    /// For the gate.
    void change(access::TokenRef token);

private:
    const Purpose purpose_;
    const std::string session_;
    const std::string user_; // tells the robots of one token apart
    const std::string hash_;

    mutable std::mutex mutex_; // guards what follows, held for a copy only
    access::TokenRef token_;
    bool changed_ = false;
    std::function<void()> told_;
};

} // namespace scanloom::guard
