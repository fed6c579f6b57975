#pragma once

#include "server/access/refusal.hpp"
#include "server/access/token.hpp"
#include "server/guard/audit.hpp"
#include "server/guard/gate.hpp"
#include "server/guard/logins.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/router.hpp"

#include <optional>
#include <string_view>
#include <utility>
#include <variant>

namespace scanloom::http {

/// Who asks, and whether his token allows it.
///
/// Whoever may not see a session is told the same of one that exists and of one that does not.
/// Thread  any; what it refers to must outlive it.
class Doorman {
public:
    Doorman(guard::Gate& gate, guard::Audit& audit, guard::Logins& logins)
        : gate_(gate), audit_(audit), logins_(logins) {}

    /// The token, null for somebody unknown where anybody may ask; or the answer that refuses.
    [[nodiscard]] std::variant<access::TokenRef, Response> admit(const Request& request, const Match& match) const;

    /// Why the token is not for that session, if it is not.
    [[nodiscard]] static std::optional<guard::Denied> objection(const access::Token& token, std::string_view session);

    /// Tells the audit. @return 401 with WWW-Authenticate where no known token was shown, else 403.
    [[nodiscard]] Response refuse(const Request& request, const guard::Denied& why,
                                  std::string_view session = {}) const;

    /// Tells the audit alone.
    void note(access::Refusal refusal) const { audit_.note(std::move(refusal)); }

    /// The same error; the audit is told where it says that a limit is reached.
    [[nodiscard]] Error noted(const Call& call, Error error, std::string_view session) const;

    [[nodiscard]] guard::Gate& gate() const noexcept { return gate_; }
    [[nodiscard]] guard::Logins& logins() const noexcept { return logins_; }

private:
    void note(const Request& request, const guard::Denied& why, std::string_view session) const;
    [[nodiscard]] guard::Admitted<access::TokenRef> identify(const Request& request) const;
    [[nodiscard]] guard::Admitted<access::TokenRef> identify_browser(const Request& request,
                                                                     std::string_view cookie) const;

    guard::Gate& gate_;
    guard::Audit& audit_;
    guard::Logins& logins_;
};

} // namespace scanloom::http
