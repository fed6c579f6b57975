#include "server/ingest/link_permission.hpp"

#include <fmt/format.h>

namespace scanloom::ingest {

Result<> LinkPermission::request(const wire::Hello& hello, Time now, const std::function<void()>& on_change) {
    auto credential = authenticator_.grant_robot_link(hello.token, hello.session, hello.robot);
    if (!credential) {
        const auto& why = credential.error();
        on_refused_(why.reason, why.token, hello.session);
        return prefixed("hello.token: ", why.error);
    }
    credential_ = std::move(*credential);
    session_ = hello.session;
    apply(now);
    if (protocol_.ended_by()) return *protocol_.ended_by();
    credential_->when_changed(on_change);
    return {};
}

void LinkPermission::apply(Time now) {
    if (!credential_) return;
    if (auto token = credential_->token()) {
        token_ = std::move(token);
        const auto& limits = token_->limits;
        protocol_.set_limits({token_->name, limits.bytes_per_second, limits.sensors, limits.beams}, now);
        return;
    }
    const std::string name = token_ ? token_->name : std::string();
    on_refused_(auth::Reason::kRevoked, name, session_);
    protocol_.fail({Errc::kUnauthorized,
                    fmt::format("the token '{}' no longer permits this; ask the server's operator for another", name)});
}

} // namespace scanloom::ingest
