#include "tests/unit/server/http/api_fixture.hpp"

#include "core/mapping/snapshot.hpp"
#include "server/http/handlers/lookup.hpp"

#include <boost/asio/post.hpp>
#include <boost/json/array.hpp>

#include <functional>
#include <thread>
#include <utility>

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

    /// Returns the list of replay jobs; it is empty before the settings are posted.
    boost::json::value listed_after(const std::string& settings) {
        EXPECT_EQ(get_json("/api/v1/sessions/a/weave").at("weaves"), boost::json::array{});
        start(settings);
        return get_json("/api/v1/sessions/a/weave").at("weaves");
    }

    /// Returns the id of a finished replay job.
    std::string finished_job(const std::string& body) {
        const std::string id(start(body).at("id").as_string());
        finish_weave("a", id);
        return id;
    }
};

TEST_F(ApiWeavesTest, MapsEqualThoseOfASessionWithTheSettings) {
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
    for (const char* until :
         {"", "x", "-1", "1.5", "s", "1970-02-30T00:00:00Z", "1970-01-01 00:00:00Z", "nans", "1970-01-01T24:00:00Z",
          "1970-01-01T00:00:00", "1970-01-01T00:00:371e5Z", "1970-01-01T00:00:37.Z", "1970-01-01T00:00:37.5e3Z",
          "1970-01-01T00:00:3-Z", "1970-01-01T00:00:370Z"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/a/digest?until={}", until)), Status::bad_request),
                    HasSubstr("until"))
            << until;
    }
    EXPECT_THAT(detail(get("/api/v1/sessions/a/digest?until=8"), Status::conflict), HasSubstr("revision 7"));
}

TEST_F(ApiWeavesTest, InvalidSettingsAreNamed) {
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
             {R"({"until":true})", "until is true; a revision (912), a stamp in seconds (976052857.5s) or a time"},
             {R"({"until":-1})", "until is -1;"},
             {R"({"until":1.5})", "until is 1.5;"},
             {R"({"until":1e30})", "until is 1e+30;"},
             {R"({"until":null})", "until is null;"},
             {R"({"until":{"stamp":[1]}})", R"(until is {"stamp":[1]};)"},
             {R"({"until":"soon"})", R"(until is "soon";)"},
             {R"({"name":"b"})", "name"},
             {"[]", "not an object"}}) {
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/a/weave", body), Status::bad_request), HasSubstr(name));
    }
    EXPECT_EQ(get_json("/api/v1/sessions/a/weave"), (boost::json::object{{"weaves", boost::json::array{}}}));
}

TEST_F(ApiWeavesTest, AllMapRoutesAcceptAReplayJob) {
    const auto id = finished_job(R"({"cell_size":0.1,"until":6})");
    EXPECT_EQ(finished_job(R"({"until":"6","cell_size":0.1})"), id) << "the same again";
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

TEST_F(ApiWeavesTest, JobsOfGetDoNotEvictJobsOfPost) {
    const auto id = finished_job(R"({"cell_size":0.1})");
    for (int n = 1; n <= 40; ++n) {
        const auto digest = get(fmt::format("/api/v1/sessions/a/digest?danger_radius={}", 0.01 * n));
        EXPECT_EQ(digest.status, Status::ok);
    }
    const auto weaves = get_json("/api/v1/sessions/a/weave").at("weaves").as_array();
    ASSERT_EQ(weaves.size(), 1U);
    EXPECT_EQ(weaves[0].at("id").as_string(), id);
}

TEST_F(ApiWeavesTest, RepeatedSettingsFollowTheSession) {
    const std::string digest = "/api/v1/sessions/a/digest?cell_size=0.1";
    EXPECT_EQ(get_json(digest).at("revision"), 7);
    stream("a", 6, 6); // revision 8
    EXPECT_EQ(get_json(digest).at("revision"), 8);
    stream("a", 9, 7);
    const auto replayed = get_json(digest);
    EXPECT_EQ(replayed.at("revision"), 11);
    ASSERT_EQ(ask("POST", "/api/v1/sessions", R"({"name":"b","cell_size":0.1})").status, Status::created);
    stream("b", 9);
    EXPECT_EQ(replayed, get_json("/api/v1/sessions/b/digest"));
    const auto weaves = listed_after(R"({"cell_size":0.1})");
    ASSERT_EQ(weaves.as_array().size(), 1U);
    EXPECT_EQ(weaves.at(0).at("revision"), 11);
    EXPECT_EQ(weaves.at(0).at("woven"), 11);
    EXPECT_EQ(weaves.at(0).at("until"), (boost::json::value{{"revision", 11}, {"stamp", nullptr}}));
    EXPECT_EQ(weaves.at(0).at("follows"), true);
}

TEST_F(ApiWeavesTest, PastTimeKeepsItsJobWhenTheSessionGrows) {
    const auto past = get_json("/api/v1/sessions/a/digest?until=103.5s");
    stream("a", 6, 6);
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest?until=103.5s"), past);
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest?until=1970-01-01T00:01:43.5Z"), past);
    const auto weaves = listed_after(R"({"until":"103.5s"})");
    ASSERT_EQ(weaves.as_array().size(), 1U);
    EXPECT_EQ(weaves.at(0).at("until"), (boost::json::value{{"revision", 5}, {"stamp", 103.5}}));
    EXPECT_EQ(weaves.at(0).at("follows"), false);
}

TEST_F(ApiWeavesTest, JobByIdIsUnchangedUntilPostedAgain) {
    const auto id = finished_job(R"({"cell_size":0.1})");
    const auto by_id = "/api/v1/sessions/a/digest?weave=" + id;
    stream("a", 6, 6);
    EXPECT_EQ(get_json(by_id).at("revision"), 7);
    EXPECT_EQ(finished_job(R"({"cell_size":0.1})"), id);
    EXPECT_EQ(get_json(by_id).at("revision"), 8);
    EXPECT_EQ(ask("POST", "/api/v1/sessions/a/weave", R"({"cell_size":0.1})").status, Status::ok)
        << "all entries are applied";
}

TEST_F(ApiWeavesTest, EntityTagsChangeWithTheMapsOfAJob) {
    const std::string map = "/api/v1/sessions/a/map.png?cell_size=0.1";
    const auto id = finished_job(R"({"cell_size":0.1})");
    const std::string tile = "/api/v1/sessions/a/tiles/occupancy/9/256/255.bin";
    const auto versioned =
        fmt::format("{}?weave={}&v=8&id={}-{}", tile, id, session_tag(registry_.find("a")->info()), id);
    const auto earlier_map = get(map);
    const auto earlier_tile = get(tile + "?weave=" + id);
    EXPECT_EQ(get(map, std::string(earlier_map.get("ETag"))).status, Status::not_modified);
    EXPECT_EQ(get(versioned).get("Cache-Control"), kRevalidate) << "entry 8 does not exist yet";

    stream("a", 6, 6);
    finished_job(R"({"cell_size":0.1})");
    const auto map_now = get(map, std::string(earlier_map.get("ETag")));
    EXPECT_EQ(map_now.status, Status::ok);
    EXPECT_NE(map_now.body.bytes(), earlier_map.body.bytes());
    const auto tile_now = get(tile + "?weave=" + id, std::string(earlier_tile.get("ETag")));
    EXPECT_EQ(tile_now.status, Status::ok);
    EXPECT_NE(tile_now.body.bytes(), earlier_tile.body.bytes());
    EXPECT_EQ(get(versioned).get("Cache-Control"), kImmutable);
}

/// An API whose replay jobs wait until let_go().
class ApiHeldWeavesTest : public ApiWeavesTest {
protected:
    ApiHeldWeavesTest() {
        boost::asio::post(one_, [this] { go_on_.get_future().wait(); });
        held_api_.set_recovered();
    }
    ~ApiHeldWeavesTest() override {
        held_.stop();
        let_go();
        one_.join();
    }

    void let_go() {
        if (!std::exchange(gone_on_, true)) go_on_.set_value();
    }

    /// Requests the map with these settings and calls `meanwhile` while the request waits. @return the response
    Response waited_for(const std::string& settings, const std::function<void()>& meanwhile) {
        Request request;
        request.method = "GET";
        request.target = "/api/v1/sessions/a/map.png?" + settings;
        auto response = std::async(std::launch::async, [&] { return answer(held_api_, request); });
        while (held_.under_way() == 0) std::this_thread::yield();
        meanwhile();
        return response.get();
    }

    boost::asio::thread_pool one_{1};
    std::promise<void> go_on_;
    bool gone_on_ = false;
    sessions::ReplayJobs held_{log_, one_.get_executor()};
    TestApi held_api_{registry_, held_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {}};
};

TEST_F(ApiHeldWeavesTest, DeletedSessionEndsWaitingRequests) {
    const auto response = waited_for("cell_size=0.1", [&] {
        Request request;
        request.method = "DELETE";
        request.target = "/api/v1/sessions/a";
        EXPECT_EQ(answer(held_api_, request).status, Status::no_content);
    });
    EXPECT_THAT(detail(response, Status::not_found), StartsWith("session 'a' was deleted"));
}

TEST_F(ApiHeldWeavesTest, WaitingRequestsGetTheirRevisionOrALaterOne) {
    const auto response = waited_for("cell_size=0.1", [&] { let_go(); });
    EXPECT_EQ(response.status, Status::ok);
    EXPECT_EQ(response.get("ETag"), get("/api/v1/sessions/a/map.png?cell_size=0.1").get("ETag"));
}

TEST_F(ApiHeldWeavesTest, TimedOutRequestReportsProgressAndRejoins) {
    held_api_.services().replay_timeout = std::chrono::milliseconds(0);
    const Request request{.target = "/api/v1/sessions/a/map.png?cell_size=0.1"};
    EXPECT_THAT(detail(answer(held_api_, request), Status::service_unavailable),
                HasSubstr("0 of 7 entries are applied; retry soon"));
    stream("a", 6, 6);
    EXPECT_THAT(detail(answer(held_api_, request), Status::service_unavailable),
                HasSubstr("0 of 8 entries are applied"));
    EXPECT_EQ(held_.under_way(), 1U);
}

TEST_F(ApiHeldWeavesTest, WaitingRequestsAreBoundedAndBlockNoThread) {
    TestApi api(registry_, held_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {}, {.weaves_max = 1});
    api.set_recovered();
    const auto first = api.start({.target = "/api/v1/sessions/a/digest?cell_size=0.1"});
    while (held_.under_way() == 0) api.poll(*first);
    EXPECT_THAT(first->asked.work, testing::ElementsAre(WorkClass::kWholeMaps));
    const auto refused = api.answer({.target = "/api/v1/sessions/a/map.png?cell_size=0.2"});
    EXPECT_THAT(detail(refused, Status::service_unavailable), HasSubstr("too many requests are waiting for maps"));
    EXPECT_EQ(api.answer({.target = "/api/v1/sessions/a/digest"}).status, Status::ok) << "on the same thread";
    EXPECT_FALSE(first->done);
    let_go();
    while (!first->done) api.poll(*first);
    EXPECT_EQ(first->asked.response->status, Status::ok);
    EXPECT_EQ(api.answer({.target = "/api/v1/sessions/a/map.png?cell_size=0.2"}).status, Status::ok);
}

TEST_F(ApiWeavesTest, DeletedJobIsNotFound) {
    const auto id = finished_job("{}");
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a/weave/" + id).status, Status::no_content);
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a/weave/" + id).status, Status::not_found);
    EXPECT_EQ(get("/api/v1/sessions/a/weave/" + id).status, Status::not_found);
    EXPECT_THAT(detail(get("/api/v1/sessions/a/map.png?weave=" + id), Status::not_found), HasSubstr("no replay job"));
    const auto kept = finished_job("{}");
    ASSERT_EQ(ask("DELETE", "/api/v1/sessions/a").status, Status::no_content);
    create("a");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?weave=" + kept).status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
