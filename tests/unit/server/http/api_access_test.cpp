#include "tests/unit/server/http/api_access_fixture.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace scanloom::http {
namespace {

using auth::Role;
using auth::Token;

bool is_let_in(const Response& response) {
    return response.status != Status::unauthorized && response.status != Status::forbidden;
}

/// Foxglove and Lichtblick cannot send an Authorization field.
TEST_F(ApiAccessTest, OnlyFoxgloveTakesATokenInTheAddress) {
    const auto watch = [&](const std::string& target) {
        Request asked = request("GET", "/api/v1/sessions/depot-1/" + target, "");
        asked.upgrade = WebSocketUpgrade{.version = "13", .key = "dGhlIHNhbXBsZSBub25jZQ==", .origin = ""};
        asked.upgrade->protocols = "foxglove.sdk.v1";
        return answer(api_, asked).status;
    };
    EXPECT_EQ(watch("foxglove"), Status::unauthorized);
    EXPECT_EQ(watch("foxglove?token=secret%20of%20viewer"), Status::switching_protocols);
    EXPECT_EQ(watch("foxglove?token=secret"), Status::unauthorized);
    EXPECT_EQ(watch("foxglove?token=secret%20of%20robot"), Status::forbidden);
    EXPECT_EQ(watch("live?token=secret%20of%20viewer"), Status::unauthorized);
    EXPECT_EQ(watch("map.png?token=secret%20of%20viewer"), Status::unauthorized);
}

/// A copy of the table in docs/security.md.
TEST_F(ApiAccessTest, EachRoleIsPermittedItsOwnRequestsOnly) {
    const std::set<std::string_view> open = {"/",       "/assets/{file}", "/livez",
                                             "/readyz", "/openapi.json",  "/api/v1/login"};
    const std::set<std::string_view> change_nothing = {"plan", "coverage", "weave"};
    for (const auto& route : routes()) {
        if (open.contains(route.path)) continue; // OpenRoutesNeedNoToken
        const std::string method(name_of(route.method));
        const bool looks = method == "GET" || change_nothing.contains(route.path.substr(route.path.rfind('/') + 1));
        const bool names_one = route.path.find("{session}") != std::string_view::npos;
        for (const auto* session : {"depot-1", "depot-none", "lab", "none"}) {
            const std::string_view name = session;
            const bool matches = !names_one || name.starts_with("depot-");
            const auto target = target_of(route, session);
            const auto allowed = [&](const std::string& who) {
                return is_let_in(ask_as(who, method, target, method == "POST" ? "[]" : ""));
            };
            const bool is_metrics = route.path == "/metrics" || route.path == "/api/v1/nodes";
            const bool is_store = route.path == "/api/v1/backups" || route.path == "/api/v1/node/drain";
            EXPECT_FALSE(allowed("")) << method << " " << target;
            EXPECT_FALSE(allowed("unknown")) << method << " " << target;
            const bool guides = method == "POST" && route.path.ends_with("/goal");
            EXPECT_EQ(allowed("robot"), is_metrics || guides) << method << " " << target;
            EXPECT_EQ(allowed("viewer"), looks && matches && !is_metrics && !is_store) << method << " " << target;
            EXPECT_EQ(allowed("viewer-all"), looks && !is_store) << method << " " << target;
            if (method == "DELETE" && name != "none" && name != "depot-none") continue; // the next requests need it
            EXPECT_EQ(allowed("operator"), matches && !is_metrics && !is_store) << method << " " << target;
            EXPECT_TRUE(allowed("operator-all")) << method << " " << target;
        }
    }
    EXPECT_EQ(ask_as("operator", "DELETE", "/api/v1/sessions/depot-1").status, Status::no_content);
    EXPECT_EQ(ask_as("operator-all", "DELETE", "/api/v1/sessions/lab").status, Status::no_content);
}

/// Requests without permission, and requests of foreign pages, do not change the responses to other clients.
TEST_F(ApiAccessTest, ViewersCannotChangeSessions) {
    stream("depot-1", 3);
    const std::map<std::string_view, std::string> bodies = {
        {"/api/v1/login", R"({"token":"secret of operator-all"})"},
        {"/api/v1/sessions", R"({"name":"depot-new"})"},
        {"/api/v1/sessions/{session}/plan", R"({"from":{"robot":"r1"},"to":[0.5,0.1]})"},
        {"/api/v1/sessions/{session}/goal", R"({"robot":"r1","size_min":1,"body_radius":0})"},
        {"/api/v1/sessions/{session}/weave", R"({"cell_size":0.1})"},
        {"/api/v1/sessions/{session}/exclude", R"({"robot":"r1","from":0,"to":200})"},
    };
    const auto state = [&] {
        std::string seen;
        for (const auto* path : {"", "/depot-1", "/depot-1/goals.geojson", "/depot-1/goal?robot=r1", "/depot-1/weave",
                                 "/depot-1/digest", "/depot-1/exclusions"}) {
            const auto answer = ask_as("operator-all", "GET", std::string("/api/v1/sessions") + path);
            EXPECT_EQ(answer.status, Status::ok) << path;
            seen.append(answer.body.bytes());
        }
        return seen.append(ask_as("operator-all", "GET", "/api/v1/backups").body.bytes());
    };
    const auto before = state();
    for (const auto& route : routes()) {
        const bool only_reads = route.method == Method::kGet;
        const bool is_weave = name_of(route.method) == "POST" &&
                              route.path.ends_with("/weave"); // viewers may start one, and it is listed
        const auto body = bodies.contains(route.path) ? bodies.at(route.path) : "{}";
        for (const auto* who : {"", "unknown", "robot", "viewer", "viewer-all", "operator-all"}) {
            for (const auto* origin : {"", "http://elsewhere", "http://maps.lab:9090", "http://localhost:8080"}) {
                const std::string name(who);
                const bool guides = name == "robot" && route.path.ends_with("/goal");
                if (!only_reads && (name == "operator-all" || guides || (is_weave && name.starts_with("viewer"))))
                    continue;
                for (const std::string query : {"", "?robot=r1", "?cell_size=0.2"}) {
                    auto asked =
                        request(std::string(name_of(route.method)), target_of(route, "depot-1") + query, name, body);
                    asked.origin = origin;
                    answer(api_, asked);
                    if (only_reads) {
                        asked.method = "HEAD";
                        answer(api_, asked);
                    }
                }
            }
        }
        ASSERT_EQ(state(), before) << name_of(route.method) << " " << route.path;
    }
    EXPECT_EQ(
        ask_as("robot", "POST", "/api/v1/sessions/depot-1/goal", bodies.at("/api/v1/sessions/{session}/goal")).status,
        Status::ok);
    EXPECT_NE(state(), before) << "otherwise this test cannot detect a change";
}

TEST_F(ApiAccessTest, HeadNeedsThePermissionOfGet) {
    EXPECT_EQ(ask_as("", "HEAD", "/api/v1/sessions/lab").status, Status::unauthorized);
    EXPECT_EQ(ask_as("viewer", "HEAD", "/api/v1/sessions/lab").status, Status::forbidden);
    EXPECT_EQ(ask_as("viewer", "HEAD", "/api/v1/sessions/depot-1").status, Status::ok);
}

TEST_F(ApiAccessTest, RequestWithoutTokenIsUnauthorized) {
    const auto none = ask_as("", "GET", "/api/v1/sessions");
    EXPECT_THAT(detail(none, Status::unauthorized), HasSubstr("a token is needed"));
    EXPECT_EQ(none.get("WWW-Authenticate"), R"(Bearer realm="scanloom")");
    const auto unknown = ask_as("unknown", "GET", "/api/v1/sessions");
    EXPECT_THAT(detail(unknown, Status::unauthorized), HasSubstr("not valid here"));
    EXPECT_EQ(unknown.get("WWW-Authenticate"), R"(Bearer realm="scanloom", error="invalid_token")");
    EXPECT_EQ(refusals(auth::Reason::kNoToken), 1.0);
    EXPECT_EQ(refusals(auth::Reason::kUnknownToken), 1.0);
}

/// A difference would disclose which sessions exist.
TEST_F(ApiAccessTest, ForbiddenAndUnknownSessionsHaveEqualResponses) {
    const auto without = [](std::string text, const std::string& name) {
        for (auto at = text.find(name); at != std::string::npos; at = text.find(name)) text.erase(at, name.size());
        return text;
    };
    for (const auto& route : routes()) {
        if (route.path.find("{session}") == std::string_view::npos) continue;
        const auto answers = [&](const std::string& session) {
            const auto target = target_of(route, session);
            const auto response = ask_as("operator", std::string(name_of(route.method)), target, "{}");
            return std::pair(response.status, without(std::string(response.body.bytes()), session));
        };
        EXPECT_EQ(answers("lab").first, Status::forbidden) << route.path;
        EXPECT_EQ(answers("lab"), answers("bal")) << route.path;
    }
    const auto made = [&](const std::string& name) {
        return without(
            detail(ask_as("operator", "POST", "/api/v1/sessions", R"({"name":")" + name + R"("})"), Status::forbidden),
            name);
    };
    EXPECT_EQ(made("lab"), made("bal"));
}

TEST_F(ApiAccessTest, ListsContainOnlySessionsOfTheToken) {
    const auto names = [&](const std::string& who) {
        std::vector<std::string> shown;
        const auto page = boost::json::parse(ask_as(who, "GET", "/api/v1/sessions").body.bytes());
        for (const auto& session : page.at("sessions").as_array()) shown.emplace_back(session.at("name").as_string());
        return shown;
    };
    EXPECT_THAT(names("viewer"), testing::ElementsAre("depot-1"));
    EXPECT_THAT(names("viewer-all"), testing::ElementsAre("depot-1", "lab"));
    // The end of a page does not disclose that another session follows.
    const auto page = boost::json::parse(ask_as("viewer", "GET", "/api/v1/sessions?limit=1").body.bytes());
    EXPECT_TRUE(page.at("next").is_null());
}

TEST_F(ApiAccessTest, OperatorsCreateOnlySessionsOfTheirPatterns) {
    EXPECT_EQ(ask_as("operator", "POST", "/api/v1/sessions", R"({"name":"depot-2"})").status, Status::created);
    EXPECT_EQ(ask_as("operator", "POST", "/api/v1/sessions", R"({"name":"attic"})").status, Status::forbidden);
    EXPECT_EQ(registry_.find("attic"), nullptr);
}

TEST_F(ApiAccessTest, CreatingBeyondTheSessionLimitIsRefused) {
    auto two = *token("two", Role::kOperator, {"*"});
    two.limits.sessions = 2;
    authenticator_.replace(auth::TokenSet({std::make_shared<const Token>(two)}));
    const auto make = [&](const std::string& name) {
        return ask_as("two", "POST", "/api/v1/sessions", R"({"name":")" + name + R"("})");
    };
    EXPECT_EQ(make("a").status, Status::created);
    EXPECT_EQ(make("b").status, Status::created);
    EXPECT_THAT(detail(make("c"), Status::insufficient_storage), AllOf(HasSubstr("'two'"), HasSubstr("`sessions`")));
    EXPECT_EQ(refusals(auth::Reason::kLimit), 1.0);
    EXPECT_EQ(ask_as("two", "DELETE", "/api/v1/sessions/depot-1").status, Status::no_content);
    EXPECT_EQ(make("c").status, Status::insufficient_storage) << "it belongs to another token";
    EXPECT_EQ(ask_as("two", "DELETE", "/api/v1/sessions/a").status, Status::no_content);
    EXPECT_EQ(make("c").status, Status::created);
}

TEST_F(ApiAccessTest, ReadinessListsOnlySessionsOfTheToken) {
    store::MemoryScanLog damaged;
    static_cast<void>(damaged.create_session("no record")); // cannot be read
    sessions::SessionRegistry registry(damaged, {pool_.get_executor(), [] { return 0.0; }});
    ASSERT_TRUE(registry.recover());
    ASSERT_EQ(registry.damaged().size(), 1U);
    TestApi api(registry, weaves_, goals_, damaged, metrics_, {authenticator_, audit_, logins_}, {});
    api.set_recovered();
    const auto count = [&](const std::string& who) {
        const auto response = api.answer(request("GET", "/readyz", who));
        EXPECT_EQ(response.status, Status::ok);
        return boost::json::parse(response.body.bytes()).at("damaged").as_array().size();
    };
    EXPECT_EQ(count(""), 0U);
    EXPECT_EQ(count("unknown"), 0U);
    EXPECT_EQ(count("viewer"), 0U);
    EXPECT_EQ(count("viewer-all"), 1U);
    registry.drain();
}

TEST_F(ApiAccessTest, TilesAreNotCachedByProxies) {
    stream("lab", 1);
    const auto session = boost::json::parse(ask_as("viewer-all", "GET", "/api/v1/sessions/lab").body.bytes());
    const auto tile =
        fmt::format("/api/v1/sessions/lab/tiles/occupancy/9/256/255.png?v={}&id={}",
                    session.at("revision").to_number<int>(), std::string_view(session.at("id").as_string()));
    const std::string kept = "private, max-age=31536000, immutable";
    EXPECT_EQ(ask_as("viewer-all", "GET", tile).get("Cache-Control"), kept);
    const auto at_once = api_.ask(request("GET", tile, "viewer-all"));
    EXPECT_TRUE(at_once.work.empty());
    EXPECT_EQ(at_once.response->get("Cache-Control"), kept);
}

TEST_F(ApiAccessTest, HeadersAreAuthorizedBeforeTheBodyIsRead) {
    const auto refused = [&](const std::string& who, const std::string& target, std::string type) {
        auto asked = request("POST", target, who);
        asked.content_type = std::move(type);
        const auto refusal = api_.refuse(asked);
        return refusal ? refusal->status : Status::unknown;
    };
    const std::string form = "multipart/form-data; boundary=x";
    EXPECT_EQ(refused("", "/api/v1/sessions/depot-1/import", form), Status::unauthorized);
    EXPECT_EQ(refused("viewer", "/api/v1/sessions/depot-1/import", form), Status::forbidden);
    EXPECT_EQ(refused("operator", "/api/v1/sessions/lab/import", form), Status::forbidden);
    EXPECT_EQ(refused("operator", "/api/v1/sessions/depot-1/import", "text/csv"), Status::unsupported_media_type);
    EXPECT_EQ(refused("operator", "/api/v1/sessions/depot-1/import", form), Status::unknown) << "it is not refused";
    EXPECT_EQ(refused("", "/nowhere", form), Status::not_found);
    EXPECT_EQ(refused("", "/livez", form), Status::method_not_allowed);
    EXPECT_EQ(refused("", "/a/../b", form), Status::bad_request);
}

} // namespace
} // namespace scanloom::http
