#include "tests/unit/server/http/api_fixture.hpp"

#include "server/mapping/digest.hpp"

#include <boost/json/array.hpp>

namespace scanloom::http {
namespace {

class ApiWeavesTest : public ApiTest {
protected:
    ApiWeavesTest() {
        create("a");
        stream("a", 5); // revisions 3 to 7, stamps 101 to 105
    }

    boost::json::value start(const std::string& body) {
        const auto response = ask("POST", "/api/v1/sessions/a/weave", body);
        EXPECT_TRUE(response.status == Status::accepted || response.status == Status::ok) << response.body.bytes();
        return boost::json::parse(response.body.bytes());
    }

    /// The id of a weave that is done.
    std::string woven(const std::string& body) {
        const std::string id(start(body).at("id").as_string());
        EXPECT_TRUE(weaves_.find(registry_.find("a")->info().id, id)->wait(std::chrono::minutes(2)));
        return id;
    }
};

TEST_F(ApiWeavesTest, SettingsGiveTheDigestOfASessionCreatedWithThem) {
    for (const std::string settings : {"cell_size=0.1", "ray_model=traversal", "class_source=himm&himm_increment=5",
                                       "ray_model=bresenham&accumulate=true&hit_radius=0.1"}) {
        std::string body = R"({"name":"b")";
        for (std::string_view rest = settings; !rest.empty();) {
            const auto one = rest.substr(0, rest.find('&'));
            const auto name = one.substr(0, one.find('='));
            const auto value = one.substr(name.size() + 1);
            const bool is_word = value.front() >= 'a' && value != "true";
            body += is_word ? fmt::format(R"(,"{}":"{}")", name, value) : fmt::format(R"(,"{}":{})", name, value);
            rest.remove_prefix(std::min(rest.size(), one.size() + 1));
        }
        ASSERT_EQ(ask("POST", "/api/v1/sessions", body + "}").status, Status::created) << body;
        stream("b", 5);
        EXPECT_EQ(get_json("/api/v1/sessions/a/digest?" + settings), get_json("/api/v1/sessions/b/digest")) << settings;
        EXPECT_NE(get_json("/api/v1/sessions/a/digest?" + settings), get_json("/api/v1/sessions/a/digest")) << settings;
        EXPECT_EQ(std::string(get("/api/v1/sessions/a/map.pgm?" + settings).body.bytes()),
                  std::string(get("/api/v1/sessions/b/map.pgm").body.bytes()));
        ASSERT_EQ(ask("DELETE", "/api/v1/sessions/b").status, Status::no_content);
    }
}

TEST_F(ApiWeavesTest, UntilIsARevisionOrATime) {
    for (const auto& [until, revision] : std::initializer_list<std::pair<const char*, int>>{
             {"5", 5}, {"7", 7}, {"103.5s", 5}, {"1970-01-01T00:01:43.5Z", 5}, {"1970-01-01T00:01:41Z", 3}, {"0", 0}}) {
        const auto digest = get_json(fmt::format("/api/v1/sessions/a/digest?until={}", until));
        EXPECT_EQ(digest.at("revision"), revision) << until;
    }
    for (const char* until : {"", "x", "-1", "1.5", "s", "1970-02-30T00:00:00Z", "1970-01-01 00:00:00Z", "nans",
                              "1970-01-01T24:00:00Z", "1970-01-01T00:00:00"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/a/digest?until={}", until)), Status::bad_request),
                    HasSubstr("until"))
            << until;
    }
    EXPECT_THAT(detail(get("/api/v1/sessions/a/digest?until=8"), Status::conflict), HasSubstr("revision 7"));
}

TEST_F(ApiWeavesTest, WrongSettingsAreRefusedByName) {
    for (const auto& [query, name] : std::initializer_list<std::pair<const char*, const char*>>{
             {"cell_size=0", "cell_size is 0"},
             {"cell_size=wide", "cell_size must be a number"},
             {"ray_model=laser", "ray_model must be one of"},
             {"hit_radius=0.1", "hit_radius is 0.1"},
             {"danger_cells=1.5", "danger_cells must be a whole number"},
             {"cell_sizes=1", "cell_sizes"}}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/a/map.png?{}", query)), Status::bad_request),
                    HasSubstr(name));
    }
    for (const auto& [body, name] : std::initializer_list<std::pair<const char*, const char*>>{
             {R"({"cell_size":2})", "cell_size is 2"},
             {R"({"accumulate":1})", "accumulate must be true or false"},
             {R"({"until":true})", "until"},
             {R"({"until":-1})", "until"},
             {R"({"name":"b"})", "name"},
             {"[]", "not an object"}}) {
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/a/weave", body), Status::bad_request), HasSubstr(name));
    }
    EXPECT_EQ(get_json("/api/v1/sessions/a/weave"), (boost::json::object{{"weaves", boost::json::array{}}}));
}

TEST_F(ApiWeavesTest, AWeaveIsShownWhereverMapsAre) {
    const auto id = woven(R"({"cell_size":0.1,"until":6})");
    EXPECT_EQ(woven(R"({"until":"6","cell_size":0.1})"), id) << "the same again";
    const auto shown = get_json("/api/v1/sessions/a/weave/" + id);
    EXPECT_EQ(shown.at("state"), "done");
    EXPECT_EQ(shown.at("woven"), 6);
    EXPECT_EQ(shown.at("config").at("cell_size"), 0.1);
    EXPECT_EQ(get_json("/api/v1/sessions/a/weave").at("weaves").as_array().size(), 1U);

    const auto weave = fmt::format("weave={}", id);
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest?" + weave),
              get_json("/api/v1/sessions/a/digest?cell_size=0.1&until=6"));
    EXPECT_EQ(get_json("/api/v1/sessions/a/changes?" + weave).at("revision"), 6);
    const auto tilejson = get_json("/api/v1/sessions/a/tiles/himm.json?" + weave);
    EXPECT_EQ(tilejson.at("cell_size"), 0.1);
    EXPECT_THAT(std::string(tilejson.at("tiles").at(0).as_string()), testing::EndsWith("?" + weave));
    const auto own = get("/api/v1/sessions/a/tiles/occupancy/9/256/255.bin");
    const auto other = get("/api/v1/sessions/a/tiles/occupancy/9/256/255.bin?" + weave);
    EXPECT_NE(own.body.bytes(), other.body.bytes());
    EXPECT_NE(own.get("ETag"), other.get("ETag"));
    EXPECT_THAT(std::string(get("/api/v1/sessions/a/map.yaml?" + weave).body.bytes()), HasSubstr("resolution: 0.1"));
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?until=6&" + weave).status, Status::bad_request);
}

TEST_F(ApiWeavesTest, AWeaveThatIsGoneIsNotFound) {
    const auto id = woven("{}");
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a/weave/" + id).status, Status::no_content);
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a/weave/" + id).status, Status::not_found);
    EXPECT_EQ(get("/api/v1/sessions/a/weave/" + id).status, Status::not_found);
    EXPECT_THAT(detail(get("/api/v1/sessions/a/map.png?weave=" + id), Status::not_found), HasSubstr("no weave"));
    const auto kept = woven("{}");
    ASSERT_EQ(ask("DELETE", "/api/v1/sessions/a").status, Status::no_content);
    create("a");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?weave=" + kept).status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
