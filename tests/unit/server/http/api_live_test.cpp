#include "server/live/viewed_session.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

namespace scanloom::http {
namespace {

class ApiLiveTest : public ApiTest {
protected:
    Response upgrade(const WebSocketUpgrade& wanted, std::string target = "/api/v1/sessions/lab/live") {
        Request request;
        request.target = std::move(target);
        request.host = "localhost:8080";
        request.upgrade = wanted;
        return answer(api_, request);
    }

    const WebSocketUpgrade wanted_{.version = "13", .key = "dGhlIHNhbXBsZSBub25jZQ==", .origin = ""};
};

TEST_F(ApiLiveTest, WebSocketRequestIsUpgraded) {
    create("lab");
    const auto response = upgrade(wanted_);
    EXPECT_EQ(response.status, Status::switching_protocols);
    ASSERT_NE(response.viewed, nullptr);
    EXPECT_EQ(response.viewed->session.lock(), registry_.find("lab"));
    EXPECT_EQ(&response.viewed->paths, &goals_.paths());
    EXPECT_EQ(response.viewed->tag, get_json("/api/v1/sessions/lab").at("id").as_string());
}

TEST_F(ApiLiveTest, OtherRequestsAreUpgradeRequired) {
    create("lab");
    for (const auto& response : {get("/api/v1/sessions/lab/live"), ask("HEAD", "/api/v1/sessions/lab/live"),
                                 upgrade({.version = "8", .key = wanted_.key, .origin = ""}),
                                 upgrade({.version = "", .key = wanted_.key, .origin = ""})}) {
        EXPECT_THAT(detail(response, Status::upgrade_required), HasSubstr("version 13"));
        EXPECT_EQ(response.get("Upgrade"), "websocket");
        EXPECT_EQ(response.get("Sec-WebSocket-Version"), "13");
        EXPECT_EQ(response.viewed, nullptr);
    }
}

TEST_F(ApiLiveTest, ForeignPagesAreForbidden) {
    create("lab");
    for (const auto* origin : {"http://evil.example", "null", "http://localhost.evil.example:8080"}) {
        const auto response = upgrade({.version = "13", .key = wanted_.key, .origin = origin});
        EXPECT_THAT(detail(response, Status::forbidden), HasSubstr(origin));
        EXPECT_EQ(response.viewed, nullptr);
    }
    EXPECT_EQ(audit_.counters().of(auth::Port::kHttp, auth::Reason::kForeignPage).Value(), 3.0);
    const auto own = upgrade({.version = "13", .key = wanted_.key, .origin = "http://localhost:8080"});
    EXPECT_EQ(own.status, Status::switching_protocols);
}

TEST_F(ApiLiveTest, FoxgloveIsUpgradedToAKnownProtocol) {
    create("lab");
    WebSocketUpgrade wanted = wanted_;
    for (const auto& [offered, chosen] :
         {std::pair("foxglove.websocket.v1", "foxglove.websocket.v1"), std::pair("foxglove.sdk.v1", "foxglove.sdk.v1"),
          std::pair("x, foxglove.websocket.v1 ,foxglove.sdk.v1", "foxglove.sdk.v1")}) {
        wanted.protocols = offered;
        const auto response = upgrade(wanted, "/api/v1/sessions/lab/foxglove");
        EXPECT_EQ(response.status, Status::switching_protocols);
        ASSERT_NE(response.viewed, nullptr);
        EXPECT_EQ(response.viewed->subprotocol, chosen);
        EXPECT_EQ(response.viewed->protocol, live::Protocol::kFoxglove);
    }
    for (const auto* offered : {"", "foxglove.sdk.v2", "FOXGLOVE.SDK.V1", "foxglove.sdk.v1 foxglove.websocket.v1"}) {
        wanted.protocols = offered;
        EXPECT_THAT(detail(upgrade(wanted, "/api/v1/sessions/lab/foxglove"), Status::bad_request),
                    HasSubstr("none of foxglove.sdk.v1, foxglove.websocket.v1"))
            << offered;
    }
}

TEST_F(ApiLiveTest, FoxglovesPageMayWatchByItsOwnProtocolOnly) {
    create("lab");
    Request request;
    request.host = "localhost:8080";
    request.upgrade = wanted_;
    request.upgrade->protocols = "foxglove.sdk.v1";
    request.origin = request.upgrade->origin = "https://app.foxglove.dev";
    for (const bool is_of_viewer_page : {false, true}) {
        request.is_of_viewer_page = is_of_viewer_page;
        request.target = "/api/v1/sessions/lab/foxglove";
        EXPECT_EQ(answer(api_, request).status, is_of_viewer_page ? Status::switching_protocols : Status::forbidden);
        request.target = "/api/v1/sessions/lab/live";
        EXPECT_EQ(answer(api_, request).status, Status::forbidden);
    }
}

TEST_F(ApiLiveTest, InvalidRequestsAreRefused) {
    create("lab");
    EXPECT_THAT(detail(upgrade(wanted_, "/api/v1/sessions/hall/live"), Status::not_found), HasSubstr("hall"));
    EXPECT_THAT(detail(upgrade(wanted_, "/api/v1/sessions/lab/live?weave=x"), Status::bad_request), HasSubstr("weave"));
    EXPECT_THAT(detail(upgrade({.version = "13", .key = "short", .origin = ""}), Status::bad_request),
                HasSubstr("Sec-WebSocket-Key"));
    EXPECT_EQ(ask("POST", "/api/v1/sessions/lab/live").status, Status::method_not_allowed);
}

} // namespace
} // namespace scanloom::http
