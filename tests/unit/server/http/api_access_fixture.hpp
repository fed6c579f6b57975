#pragma once

#include "server/auth/token.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {

inline constexpr std::string_view kHost = "maps.lab:8080";

/// An API that requires tokens, with the sessions depot-1 and lab.
class ApiAccessTest : public ApiTest {
protected:
    ApiAccessTest() {
        create("depot-1");
        create("lab");
        authenticator_.replace(auth::TokenSet(all_));
    }

    /// `who` is the name of a token; empty: without a token.
    static Request request(std::string method, std::string target, const std::string& who, std::string body = "") {
        Request asked;
        asked.method = std::move(method);
        asked.target = std::move(target);
        asked.host = kHost;
        asked.content_type = "application/json";
        asked.body = std::move(body);
        asked.peer = "192.0.2.1";
        if (!who.empty()) asked.authorization = "Bearer secret of " + who;
        return asked;
    }

    Response ask_as(const std::string& who, std::string method, std::string target, std::string body = "") {
        return answer(api_, request(std::move(method), std::move(target), who, std::move(body)));
    }

    [[nodiscard]] double refusals(auth::Reason reason) {
        return audit_.counters().of(auth::Port::kHttp, reason).Value();
    }

    static auth::TokenRef token(std::string name, auth::Role role, std::vector<std::string> sessions) {
        const auto hash = auth::hash_of("secret of " + name);
        return std::make_shared<const auth::Token>(auth::Token{std::move(name), hash, role, std::move(sessions), {}});
    }

    std::vector<auth::TokenRef> all_ = {
        token("robot", auth::Role::kRobot, {"*"}),           token("viewer", auth::Role::kViewer, {"depot-*"}),
        token("viewer-all", auth::Role::kViewer, {"*"}),     token("operator", auth::Role::kOperator, {"depot-*"}),
        token("operator-all", auth::Role::kOperator, {"*"}),
    };
};

} // namespace scanloom::http
