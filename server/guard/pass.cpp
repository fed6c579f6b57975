#include "server/guard/pass.hpp"

namespace scanloom::guard {

access::TokenRef Pass::token() const {
    const std::lock_guard lock(mutex_);
    return token_;
}

void Pass::when_changed(const std::function<void()>& told) {
    bool has_changed = false;
    {
        const std::lock_guard lock(mutex_);
        told_ = told;
        has_changed = changed_;
    }
    if (has_changed) told();
}

void Pass::change(access::TokenRef token) {
    std::function<void()> told;
    {
        const std::lock_guard lock(mutex_);
        token_ = std::move(token);
        changed_ = true;
        told = told_;
    }
    if (told) told();
}

} // namespace scanloom::guard
