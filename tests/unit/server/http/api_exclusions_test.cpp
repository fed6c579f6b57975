#include "tests/unit/server/http/api_fixture.hpp"

/// Scans that an operator excludes from maps.
namespace scanloom::http {
namespace {

class ApiExclusionsTest : public ApiTest {
protected:
    void SetUp() override {
        create("a");
        Scan stray = scan(3);
        stray.pose->x = 450.0;
        stream("a", "r1", {scan(1), scan(2), stray, scan(4)});
    }

    Response exclude(std::string from, std::string to, std::string robot = "r1") {
        return ask("POST", "/api/v1/sessions/a/exclude",
                   fmt::format(R"({{"robot":"{}","from":{},"to":{}}})", robot, from, to));
    }

    boost::json::value shown() {
        static_cast<void>(get("/api/v1/sessions/a/digest")); // waits until its maps are computed
        return get_json("/api/v1/sessions/a");
    }
};

TEST_F(ApiExclusionsTest, RemoveScansFromMapsAndTextsButNotTheLog) {
    const auto log_before = log("a");
    const auto tile_before = get("/api/v1/sessions/a/tiles/occupancy/9/256/255.png");
    const auto session_before = shown();
    const auto response = exclude("103", "103.5");
    ASSERT_EQ(response.status, Status::created) << response.body.bytes();
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("revision"), 7) << "before its maps are computed";
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("exclusions"), 7);
    EXPECT_EQ(boost::json::parse(response.body.bytes()),
              (boost::json::value{{"id", 1}, {"robot", "r1"}, {"from", 103}, {"to", 103.5}, {"revision", 7}}));

    const auto session = shown();
    EXPECT_EQ(session.at("revision"), 7);
    EXPECT_EQ(session.at("scans"), 3);
    EXPECT_LT(session.at("bounds").at("max_x").to_number<double>(), 10.0);
    EXPECT_EQ(session.at("robots").at(0).at("excluded"), 1);
    EXPECT_EQ(session.at("robots").at(0).at("last_seq"), 4);
    EXPECT_EQ(session.at("exclusions"), 7);
    EXPECT_NE(session.at("id"), session_before.at("id")) << "viewers discard the earlier maps";
    EXPECT_NE(get("/api/v1/sessions/a/tiles/occupancy/9/256/255.png").get("ETag"), tile_before.get("ETag"));
    EXPECT_EQ(get_json("/api/v1/sessions/a/changes?since=6").at("reset"), true);
    EXPECT_EQ(get_json("/api/v1/sessions/a/changes?since=7").at("reset"), false);

    const auto path = get_json("/api/v1/sessions/a/trajectory.geojson").at("features").at(0).at("geometry");
    EXPECT_EQ(path.at("coordinates").as_array().size(), 3U);
    EXPECT_THAT(log("a", "?format=clf"), testing::Not(HasSubstr("450")));
    EXPECT_THAT(log("a"), StartsWith(log_before));
    const std::string digest = "/api/v1/sessions/a/digest?layer=occupancy&until=";
    EXPECT_NE(get(digest + "6").body.bytes(), get(digest + "7").body.bytes());
}

TEST_F(ApiExclusionsTest, AreListedUntilLifted) {
    const auto digest = get_json("/api/v1/sessions/a/digest").at("layers");
    ASSERT_EQ(exclude(R"("seq:2")", R"("seq:3")").status, Status::created);
    ASSERT_EQ(exclude("0", "1").status, Status::created);
    const auto listed = get_json("/api/v1/sessions/a/exclusions").at("exclusions");
    ASSERT_EQ(listed.as_array().size(), 2U);
    EXPECT_EQ(listed.at(0),
              (boost::json::value{{"id", 1}, {"robot", "r1"}, {"from", "seq:2"}, {"to", "seq:3"}, {"revision", 7}}));
    EXPECT_EQ(shown().at("scans"), 2);

    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a/exclusions/1").status, Status::no_content);
    EXPECT_EQ(get_json("/api/v1/sessions/a/exclusions").at("exclusions").as_array().size(), 1U);
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest").at("layers"), digest);
    EXPECT_THAT(detail(ask("DELETE", "/api/v1/sessions/a/exclusions/1"), Status::not_found),
                HasSubstr("no exclusion 1 in effect"));
    EXPECT_THAT(detail(ask("DELETE", "/api/v1/sessions/a/exclusions/x"), Status::not_found),
                HasSubstr("exclusion \"x\""));
}

TEST_F(ApiExclusionsTest, InvalidRequestsAreRefusedWithTheReason) {
    const auto refusal = [&](std::string from, std::string to, std::string robot = "r1") {
        return detail(exclude(std::move(from), std::move(to), std::move(robot)), Status::bad_request);
    };
    EXPECT_THAT(detail(exclude("1", "2", "r9"), Status::not_found), HasSubstr("no robot of that name"));
    EXPECT_THAT(refusal("2", "1"), HasSubstr("from is greater than to"));
    EXPECT_THAT(refusal("1", R"("seq:2")"), HasSubstr("two kinds"));
    for (const auto* wrong : {R"("seq:")", R"("seq:-1")", R"("seq:1.5")", R"("1")", "null", "[]", "1e999"}) {
        EXPECT_THAT(refusal(wrong, "2"), StartsWith("from is ")) << wrong;
    }
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/a/exclude", R"({"robot":"r1","from":1})"), Status::bad_request),
                StartsWith("to is missing"));
    EXPECT_THAT(get_json("/api/v1/sessions/a/exclusions").at("exclusions").as_array(), testing::IsEmpty());
}

} // namespace
} // namespace scanloom::http
