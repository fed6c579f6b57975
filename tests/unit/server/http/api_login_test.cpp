#include "tests/unit/server/http/api_access_fixture.hpp"

namespace scanloom::http {
namespace {

constexpr std::string_view kOwnPage = "http://maps.lab:8080";

class ApiLoginTest : public ApiAccessTest {
protected:
    /// Returns its cookie in the form that a browser sends.
    std::string sign_in(const std::string& who) {
        const auto response = ask_as("", "POST", "/api/v1/login", R"({"token":"secret of )" + who + R"("})");
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        const auto cookie = response.get("Set-Cookie");
        EXPECT_THAT(std::string(cookie), HasSubstr("; HttpOnly; SameSite=Strict"));
        EXPECT_THAT(std::string(cookie), Not(HasSubstr("secret of")));
        return std::string(cookie.substr(0, cookie.find(';')));
    }

    static Request with(const std::string& cookie, std::string method, std::string target, std::string_view origin,
                        std::string body = "") {
        auto asked = request(std::move(method), std::move(target), "", std::move(body));
        asked.cookie = "theme=dark; " + cookie;
        asked.origin = origin;
        return asked;
    }
};

TEST_F(ApiLoginTest, CookieAuthenticatesUntilSignOut) {
    const auto cookie = sign_in("viewer");
    const auto look = [&](const std::string& session) {
        return answer(api_, with(cookie, "GET", "/api/v1/sessions/" + session, "")).status;
    };
    EXPECT_EQ(look("depot-1"), Status::ok);
    EXPECT_EQ(look("lab"), Status::forbidden);
    const auto who = boost::json::parse(answer(api_, with(cookie, "GET", "/api/v1/login", "")).body.bytes());
    EXPECT_EQ(who.at("token").at("name"), "viewer");
    const auto out = answer(api_, with(cookie, "DELETE", "/api/v1/login", kOwnPage));
    EXPECT_EQ(out.status, Status::no_content);
    EXPECT_THAT(std::string(out.get("Set-Cookie")), HasSubstr("Max-Age=0"));
    EXPECT_EQ(look("depot-1"), Status::unauthorized);
}

TEST_F(ApiLoginTest, ChangesByCookieNeedAnOwnOrigin) {
    const auto cookie = sign_in("operator-all");
    const auto create = [&](std::string_view origin) {
        return answer(api_, with(cookie, "POST", "/api/v1/sessions", origin, R"({"name":"new"})")).status;
    };
    for (const auto* foreign : {"", "null", "http://elsewhere", "https://maps.lab.elsewhere:8080"}) {
        EXPECT_EQ(create(foreign), Status::forbidden) << foreign;
    }
    EXPECT_EQ(refusals(auth::Reason::kForeignPage), 4.0);
    EXPECT_EQ(registry_.find("new"), nullptr);
    for (const auto& route : routes()) {
        if (route.method == Method::kGet) continue;
        const auto asked =
            with(cookie, std::string(name_of(route.method)), target_of(route, "new"), "http://elsewhere");
        EXPECT_EQ(answer(api_, asked).status, Status::forbidden) << name_of(route.method) << " " << route.path;
    }
    EXPECT_EQ(create(kOwnPage), Status::created);
    EXPECT_EQ(answer(api_, with(cookie, "DELETE", "/api/v1/login", "http://elsewhere")).status, Status::forbidden);
    EXPECT_EQ(answer(api_, with(cookie, "GET", "/api/v1/sessions", "")).status, Status::ok);
}

TEST_F(ApiTest, ChangesFromForeignPagesAreRefusedWithoutTokens) {
    const auto create = [&](std::string_view origin, std::string_view type, std::string_view target) {
        Request asked;
        asked.method = "POST";
        asked.target = target;
        asked.host = kHost;
        asked.content_type = type;
        asked.origin = origin;
        asked.body = R"({"name":"new"})";
        return answer(api_, asked);
    };
    for (const auto* foreign : {"null", "http://elsewhere", "https://maps.lab.elsewhere:8080"}) {
        const auto answered = create(foreign, "application/json", "/api/v1/sessions");
        EXPECT_EQ(answered.status, Status::forbidden) << foreign;
        EXPECT_THAT(answered.body.bytes(), HasSubstr(foreign));
        EXPECT_EQ(create(foreign, "multipart/form-data; boundary=b", "/api/v1/sessions/new/import").status,
                  Status::forbidden)
            << "browsers send it without a preflight request";
    }
    EXPECT_EQ(audit_.counters().of(auth::Port::kHttp, auth::Reason::kForeignPage).Value(), 6.0);
    const auto from_elsewhere = [&](const Route& route, std::string_view authorization) {
        Request asked;
        asked.method = name_of(route.method);
        asked.target = target_of(route, "new");
        asked.host = kHost;
        asked.content_type = "application/json";
        asked.origin = "http://elsewhere";
        asked.authorization = authorization;
        asked.body = R"({"name":"new"})";
        return answer(api_, asked).status;
    };
    for (const auto& route : routes()) {
        if (route.method == Method::kGet) continue;
        for (const auto* added_by_a_browser : {"", "Basic eDp5", "Bearer anything", "x"}) {
            EXPECT_EQ(from_elsewhere(route, added_by_a_browser), Status::forbidden)
                << name_of(route.method) << " " << route.path << " " << added_by_a_browser;
        }
    }
    EXPECT_EQ(registry_.find("new"), nullptr);
    EXPECT_EQ(create(kOwnPage, "application/json", "/api/v1/sessions").status, Status::created);
    for (const auto* foreign : {"http://maps.lab:9090", "http://maps.lab", "http://localhost:8080"}) {
        EXPECT_EQ(create(foreign, "application/json", "/api/v1/sessions/new/goal").status, Status::forbidden)
            << foreign;
    }
    EXPECT_EQ(create("", "application/json", "/api/v1/sessions").status, Status::conflict) << "a program";
    Request look;
    look.method = "GET";
    look.target = "/api/v1/sessions";
    look.host = kHost;
    look.origin = "http://elsewhere";
    EXPECT_EQ(answer(api_, look).status, Status::ok) << "its page cannot read the response";
}

TEST_F(ApiLoginTest, BearerTokenNeedsNoOrigin) {
    auto asked = request("POST", "/api/v1/sessions", "operator-all", R"({"name":"new"})");
    asked.origin = "http://elsewhere"; // no page can send that header without permission
    EXPECT_EQ(answer(api_, asked).status, Status::created);
}

TEST_F(ApiLoginTest, WebSocketAcceptsCookieOrBearerToken) {
    const auto cookie = sign_in("viewer");
    const WebSocketUpgrade upgrade{"13", "dGhlIHNhbXBsZSBub25jZQ==", std::string(kOwnPage)};
    const auto watch = [&](Request asked, std::string_view origin) {
        asked.upgrade = upgrade;
        asked.upgrade->origin = asked.origin = origin;
        return answer(api_, asked).status;
    };
    const std::string live = "/api/v1/sessions/depot-1/live";
    EXPECT_EQ(watch(with(cookie, "GET", live, ""), kOwnPage), Status::switching_protocols);
    EXPECT_EQ(watch(with(cookie, "GET", live, ""), ""), Status::forbidden);
    EXPECT_EQ(watch(with(cookie, "GET", live, ""), "http://elsewhere"), Status::forbidden);
    EXPECT_EQ(watch(request("GET", live, "viewer"), ""), Status::switching_protocols);
    EXPECT_EQ(watch(request("GET", live, "robot"), ""), Status::forbidden);
    EXPECT_EQ(watch(request("GET", live, ""), kOwnPage), Status::unauthorized);
}

TEST_F(ApiLoginTest, LoginWithAWrongTokenIsRefused) {
    const auto response = ask_as("", "POST", "/api/v1/login", R"({"token":"guess"})");
    EXPECT_EQ(response.status, Status::unauthorized);
    EXPECT_EQ(response.get("Set-Cookie"), "");
    EXPECT_EQ(refusals(auth::Reason::kUnknownToken), 1.0);
    for (const auto* wrong : {"", "{}", R"({"token":1})", R"({"token":"a","more":1})"}) {
        EXPECT_EQ(ask_as("", "POST", "/api/v1/login", wrong).status, Status::bad_request) << wrong;
    }
}

TEST_F(ApiLoginTest, OpenRoutesNeedNoToken) {
    const auto who = boost::json::parse(ask_as("", "GET", "/api/v1/login").body.bytes());
    EXPECT_EQ(who.at("needed"), true);
    EXPECT_TRUE(who.at("token").is_null());
    for (const auto* open : {"/livez", "/readyz", "/openapi.json"})
        EXPECT_EQ(ask_as("", "GET", open).status, Status::ok);
    EXPECT_EQ(ask_as("", "DELETE", "/api/v1/login").status, Status::no_content);
    EXPECT_EQ(refusals(auth::Reason::kNoToken), 0.0);
}

TEST_F(ApiTest, LoginIsNotNeededWithoutTokens) {
    const auto who = boost::json::parse(get("/api/v1/login").body.bytes());
    EXPECT_EQ(who.at("needed"), false);
    const auto response = ask("POST", "/api/v1/login", R"({"token":"any"})");
    EXPECT_EQ(response.status, Status::ok);
    EXPECT_EQ(response.get("Set-Cookie"), "");
}

} // namespace
} // namespace scanloom::http
