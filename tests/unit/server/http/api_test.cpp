#include "tests/unit/server/http/api_fixture.hpp"

/// Health, metrics and properties of all routes.
namespace scanloom::http {
namespace {

TEST_F(ApiTest, ReadinessFollowsRecoveryAndShutdown) {
    TestApi starting(registry_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {});
    const auto ready = [&](TestApi& api) { return answer(api, {.target = "/readyz"}); };
    EXPECT_EQ(ready(starting).status, Status::service_unavailable);
    EXPECT_THAT(std::string(ready(starting).body.bytes()), HasSubstr("recovered"));
    EXPECT_EQ(answer(starting, {.target = "/api/v1/sessions"}).status, Status::service_unavailable);
    EXPECT_EQ(answer(starting, {.target = "/livez"}).status, Status::ok);
    starting.set_recovered();
    EXPECT_EQ(ready(starting).status, Status::ok);
    registry_.drain();
    EXPECT_EQ(ready(starting).status, Status::service_unavailable);
    EXPECT_THAT(std::string(ready(starting).body.bytes()), HasSubstr("shutting down"));
}

TEST_F(ApiTest, ReadinessDoesNotReadTheDisk) {
    EXPECT_EQ(get("/readyz").status, Status::ok);
    EXPECT_EQ(log_.looks_at_the_disk(), 0);
    EXPECT_EQ(get("/metrics").status, Status::ok);
    EXPECT_EQ(log_.looks_at_the_disk(), 1);
}

TEST_F(ApiTest, ReadinessReportsAFailedStore) {
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    ask("POST", "/api/v1/sessions", R"({"name":"a"})");
    EXPECT_THAT(std::string(get("/readyz").body.bytes()), HasSubstr("the store failed: the disk is full"));
}

TEST_F(ApiTest, ReadinessHasTheAddressOfTheRobotPort) {
    EXPECT_TRUE(get_json("/readyz").at("robots").at("host").is_null());
    api_.services().robots = {"192.0.2.7", 7448};
    EXPECT_EQ(get_json("/readyz").at("robots"), (boost::json::object{{"host", "192.0.2.7"}, {"port", 7448}}));
}

TEST_F(ApiTest, MetricsContainNoSessionName) {
    create("private-name");
    const auto response = get("/metrics");
    EXPECT_EQ(response.get("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
    const std::string text(response.body.bytes());
    EXPECT_THAT(text, HasSubstr("scanloom_sessions 1\n"));
    EXPECT_THAT(text, HasSubstr("scanloom_build_info{version=\"1.2.3\"} 1\n"));
    EXPECT_THAT(text, HasSubstr("scanloom_store_failed 0\n"));
    EXPECT_THAT(text, HasSubstr("process_resident_memory_bytes"));
    EXPECT_THAT(text, Not(HasSubstr("private-name")));
}

TEST_F(ApiTest, EveryOperationMatchesItsDescription) {
    create("a");
    stream("a", 2);
    TestApi starting(registry_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {});
    for (const auto& route : routes()) {
        if (route.method == Method::kDelete && route.path == "/api/v1/sessions/{session}") continue; // at the end
        for (const std::string session : {"a", "missing"}) {
            const auto address = target_of(route, session);
            for (const auto* query : {"", "?odd=1", "?since=x", "?v=x", "?bbox=x", "?layer=height"}) {
                ask(std::string(name_of(route.method)), address + query, R"({"name":"b"})"); // also checks openapi.json
            }
            answer(
                starting,
                {.method = std::string(name_of(route.method)), .target = address, .content_type = "application/json"});
        }
    }
    for (const auto* session : {"a", "a", "a?odd=1"}) ask("DELETE", fmt::format("/api/v1/sessions/{}", session));
    answer(starting, {.method = "DELETE", .target = "/api/v1/sessions/a"});
}

TEST_F(ApiTest, UnknownParametersAreRefused) {
    create("a");
    for (const auto& route : routes()) {
        if (route.method == Method::kPostForm || takes_any_parameter(route)) continue;
        const auto address = target_of(route, "a") + "?odd=1";
        EXPECT_EQ(ask(std::string(name_of(route.method)), address, "{}").status, Status::bad_request) << address;
    }
    EXPECT_EQ(get("/?odd=1").body.bytes(), get("/").body.bytes());
}

TEST_F(ApiTest, UnknownRoutesAreProblems) {
    EXPECT_EQ(get("/api/v2/sessions").status, Status::not_found);
    EXPECT_EQ(get("no path").status, Status::bad_request);
    const auto refused = ask("PATCH", "/api/v1/sessions/a");
    EXPECT_EQ(refused.status, Status::method_not_allowed);
    EXPECT_EQ(refused.get("Allow"), "GET, HEAD, DELETE");
}

TEST_F(ApiTest, MissingViewerIsExplained) {
    EXPECT_EQ(get("/?session=a").status, Status::not_found);
    EXPECT_THAT(std::string(get("/").body.bytes()), HasSubstr("was not built"));
    EXPECT_EQ(get("/assets/x.js").status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
