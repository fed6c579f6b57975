#include "server/http/api.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/router.hpp"
#include "server/mapping/digest.hpp"
#include "server/session/session_registry.hpp"
#include "server/tiles/occupancy_tile.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/unit/server/http/described_answer.hpp"

#include <boost/asio/thread_pool.hpp>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <numbers>

namespace scanloom::http {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A link that says when a scan has become durable.
class Link final : public session::RobotListener {
public:
    explicit Link(std::uint64_t awaited_seq) : awaited_(awaited_seq) {}

    void on_durable(std::uint64_t durable_seq, std::size_t) override {
        if (durable_seq == awaited_) done_.set_value();
    }
    void on_failed(const Error&) override { failed_.set_value(); }
    void wait() { done_.get_future().wait(); }
    void wait_for_failure() { failed_.get_future().wait(); }

private:
    std::uint64_t awaited_;
    std::promise<void> done_;
    std::promise<void> failed_;
};

Sensor laser() {
    Sensor sensor;
    sensor.id = 1;
    sensor.name = "laser";
    sensor.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 180, 181};
    sensor.range_max = 20.0;
    return sensor;
}

/// A wall all around, two metres away.
Scan scan(std::uint64_t seq) {
    Scan taken;
    taken.seq = seq;
    taken.stamp = 100.0 + static_cast<double>(seq);
    taken.sensor = 1;
    taken.pose = {0.5 * static_cast<double>(seq), 1.25, 0.0};
    taken.ranges.assign(181, 2'000);
    return taken;
}

/// An API over sessions in memory.
class ApiTest : public testing::Test {
protected:
    ApiTest() { api_.set_recovered(); }
    ~ApiTest() override { registry_.drain(); }

    Response ask(std::string method, std::string target, std::string body = "", std::string if_none_match = "") {
        Request request;
        request.method = std::move(method);
        request.target = std::move(target);
        request.content_type = "application/json";
        request.if_none_match = std::move(if_none_match);
        request.body = std::move(body);
        return answer(api_, request);
    }

    /// Whatever is answered, openapi.json has to say so.
    static Response answer(Api& api, const Request& request) {
        auto response = api.answer(request);
        EXPECT_THAT(undescribed(request, response), testing::IsEmpty());
        return response;
    }

    Response get(std::string target, std::string if_none_match = "") {
        return ask("GET", std::move(target), "", std::move(if_none_match));
    }

    boost::json::value get_json(std::string target) {
        const auto response = get(std::move(target));
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        return boost::json::parse(response.body.bytes());
    }

    /// What a refusal says, after checking its status.
    std::string detail(const Response& response, Status status) {
        EXPECT_EQ(response.status, status) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), "application/problem+json");
        return std::string(boost::json::parse(response.body.bytes()).at("detail").as_string());
    }

    void create(std::string name) {
        ASSERT_EQ(ask("POST", "/api/v1/sessions", R"({"name":")" + name + R"("})").status, Status::created);
    }

    /// Scans 1 to `count` of robot r1, taken and woven; the link stays.
    void stream(std::string_view name, std::uint64_t count) {
        const auto session = registry_.find(name);
        const auto link = std::make_shared<Link>(count);
        std::promise<void> joined;
        session->join("r1", "", link, [&joined](const Result<session::Joined>&) { joined.set_value(); });
        joined.get_future().wait();
        session->submit(link, laser(), 0);
        std::vector<Scan> scans;
        for (std::uint64_t seq = 1; seq <= count; ++seq) scans.push_back(scan(seq));
        session->submit(link, std::move(scans), 1);
        link->wait();
        links_.push_back(link);
    }

    boost::asio::thread_pool pool_{2};
    store::MemoryScanLog log_;
    session::SessionRegistry registry_{log_, pool_.get_executor(), [] { return 1795251600.5; }};
    metrics::Metrics metrics_{"1.2.3"};
    Api api_{registry_, log_, metrics_, {}};
    std::vector<std::shared_ptr<Link>> links_;
};

TEST_F(ApiTest, ACreatedSessionIsShownWithItsDefaults) {
    const auto response = ask("POST", "/api/v1/sessions", R"({"name":"intel","cell_size":0.1})");
    EXPECT_EQ(response.status, Status::created);
    EXPECT_EQ(response.get("Location"), "/api/v1/sessions/intel");
    const auto shown = boost::json::parse(response.body.bytes());
    EXPECT_EQ(shown, get_json("/api/v1/sessions/intel"));
    EXPECT_EQ(shown.at("name"), "intel");
    EXPECT_THAT(std::string(shown.at("id").as_string()), testing::MatchesRegex("[0-9a-f]{16}-[0-9]+[.][0-9]+"));
    EXPECT_EQ(shown.at("created"), "2026-11-21T09:00:00Z");
    EXPECT_EQ(shown.at("revision"), 0);
    EXPECT_EQ(shown.at("config").at("cell_size"), 0.1);
    EXPECT_EQ(shown.at("config").at("p_occupied"), 0.9);
    EXPECT_EQ(shown.at("config").as_object().size(), 8U);
    EXPECT_TRUE(shown.at("bounds").is_null());
    EXPECT_EQ(shown.at("robots"), boost::json::array{});
}

TEST_F(ApiTest, BadSessionRequestsAreRefusedByField) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {R"({})", "name is missing"},
        {R"({"name":7})", "name is not a string"},
        {R"({"name":"a/b"})", "name"},
        {R"({"name":""})", "name"},
        {R"({"name":"a","cellsize":1})", "\"cellsize\""},
        {R"({"name":"a","cell_size":"1"})", "cell_size is not a number"},
        {R"({"name":"a","cell_size":0})", "cell_size"},
        {R"({"name":"a","cell_size":0.1,"cell_size":0.2})", "\"cell_size\" is given twice"},
        {R"({"name":"a","cell_size":-1e300})", "cell_size"},
        {R"({"name":"a","p_free":0.7})", "p_free"},
        {R"([])", "not an object"},
        {R"({"name")", "not JSON"},
    };
    for (const auto& [body, message] : cases) {
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", body), Status::bad_request), HasSubstr(message)) << body;
    }
    EXPECT_EQ(ask("POST", "/api/v1/sessions", R"({"name":"a","cell_size":1e999})").status, Status::bad_request);
    EXPECT_TRUE(registry_.list().empty());
}

TEST_F(ApiTest, ASessionIsMadeOnce) {
    create("a");
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", R"({"name":"a"})"), Status::conflict), HasSubstr("exists"));
}

TEST_F(ApiTest, OnlyJsonIsTaken) {
    Request request{
        .method = "POST", .target = "/api/v1/sessions", .content_type = "text/plain", .body = R"({"name":"a"})"};
    EXPECT_THAT(detail(answer(api_, request), Status::unsupported_media_type), HasSubstr("application/json"));
    request.content_type = "application/json; charset=utf-8";
    EXPECT_EQ(answer(api_, request).status, Status::created);
}

TEST_F(ApiTest, AFailedStoreIsUnavailable) {
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", R"({"name":"a"})"), Status::service_unavailable),
                HasSubstr("disk is full"));
}

TEST_F(ApiTest, SessionsAreListedInPages) {
    for (const auto* name : {"c", "a", "b"}) create(name);
    const auto first = get_json("/api/v1/sessions?limit=2");
    ASSERT_EQ(first.at("sessions").as_array().size(), 2U);
    EXPECT_EQ(first.at("sessions").at(0).at("name"), "a");
    EXPECT_EQ(first.at("next"), "b");
    const auto last = get_json("/api/v1/sessions?limit=2&after=b");
    ASSERT_EQ(last.at("sessions").as_array().size(), 1U);
    EXPECT_EQ(last.at("sessions").at(0).at("name"), "c");
    EXPECT_TRUE(last.at("next").is_null());
    EXPECT_TRUE(get_json("/api/v1/sessions?after=zz").at("sessions").as_array().empty());
    EXPECT_TRUE(get_json("/api/v1/sessions").at("next").is_null());
}

TEST_F(ApiTest, BadPagesAreRefusedByParameter) {
    for (const auto* query : {"limit=0", "limit=1001", "limit=x", "limit=", "limit=-1", "limit=18446744073709551616"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions?{}", query)), Status::bad_request),
                    StartsWith("limit is"));
    }
    EXPECT_THAT(detail(get("/api/v1/sessions?after=a%20b"), Status::bad_request), StartsWith("after is"));
    EXPECT_THAT(detail(get("/api/v1/sessions?page=2"), Status::bad_request), HasSubstr("\"page\""));
}

TEST_F(ApiTest, DeletedSessionsAreGoneAndTheirNameIsFree) {
    create("a");
    const auto id = get_json("/api/v1/sessions/a").at("id");
    const auto response = ask("DELETE", "/api/v1/sessions/a");
    EXPECT_EQ(response.status, Status::no_content);
    EXPECT_EQ(response.body.bytes(), "");
    EXPECT_EQ(get("/api/v1/sessions/a").status, Status::not_found);
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a").status, Status::not_found);
    create("a");
    EXPECT_NE(get_json("/api/v1/sessions/a").at("id"), id);
}

TEST_F(ApiTest, AStreamingRobotIsShown) {
    create("a");
    stream("a", 3);
    const auto shown = get_json("/api/v1/sessions/a");
    EXPECT_EQ(shown.at("scans"), 3);
    EXPECT_EQ(shown.at("revision"), 5); // and the robot's joining and its sensor
    EXPECT_EQ(shown.at("robots"), (boost::json::array{{{"name", "r1"},
                                                       {"connected", true},
                                                       {"scans", 3},
                                                       {"last_seq", 3},
                                                       {"stamp", 103},
                                                       {"pose", {{"x", 1.5}, {"y", 1.25}, {"yaw", 0}}}}}));
    EXPECT_NEAR(shown.at("bounds").at("max_x").to_number<double>(), 3.5, 0.2);
    EXPECT_NEAR(shown.at("bounds").at("min_y").to_number<double>(), -0.75, 0.2);
}

TEST_F(ApiTest, TilesShowTheMap) {
    create("a");
    stream("a", 3);
    const auto snapshot = registry_.find("a")->snapshot();
    const auto bytes = get("/api/v1/sessions/a/tiles/occupancy/9/256/255.bin");
    EXPECT_EQ(bytes.get("Content-Type"), "application/octet-stream");
    ASSERT_EQ(bytes.body.bytes().size(), 65'536U);
    const auto expected = tiles::occupancy_tile(*snapshot, {9, 256, 255});
    EXPECT_TRUE(std::equal(expected->begin(), expected->end(), bytes.body.bytes().begin(),
                           [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
    const auto image = get("/api/v1/sessions/a/tiles/occupancy/0/0/0.png");
    EXPECT_EQ(image.get("Content-Type"), "image/png");
    EXPECT_THAT(std::string(image.body.bytes()), StartsWith("\x89PNG"));
    EXPECT_EQ(get("/api/v1/sessions/a/tiles/occupancy/9/0/0.png").status, Status::ok); // never touched
}

TEST_F(ApiTest, ATileThatDidNotChangeIsNotSentAgain) {
    create("a");
    stream("a", 1);
    for (const auto* tile : {"9/256/255.png", "9/256/255.bin", "9/0/0.png"}) {
        const auto target = fmt::format("/api/v1/sessions/a/tiles/occupancy/{}", tile);
        const auto first = get(target);
        EXPECT_EQ(first.get("Cache-Control"), "no-cache");
        const std::string etag(first.get("ETag"));
        EXPECT_THAT(etag, StartsWith("\""));
        const auto again = get(target, etag);
        EXPECT_EQ(again.status, Status::not_modified);
        EXPECT_EQ(again.get("ETag"), etag);
        EXPECT_EQ(again.body.bytes(), "");
        EXPECT_EQ(get(target, "W/" + etag + ", \"x\"").status, Status::not_modified);
        EXPECT_EQ(get(target, "\"x\"").status, Status::ok);
    }
}

TEST_F(ApiTest, EntityTagFollowsTheTileAndTheSession) {
    const std::string seen = "/api/v1/sessions/a/tiles/occupancy/9/256/255.png";
    const std::string unseen = "/api/v1/sessions/a/tiles/occupancy/9/0/0.png";
    create("a");
    const std::string before(get(seen).get("ETag"));
    const std::string far(get(unseen).get("ETag"));
    stream("a", 1);
    EXPECT_NE(get(seen).get("ETag"), before);
    EXPECT_EQ(get(unseen).get("ETag"), far);
    ask("DELETE", "/api/v1/sessions/a");
    create("a");
    EXPECT_NE(get(unseen).get("ETag"), far);
}

TEST_F(ApiTest, AnotherVersionOfTheProgramSharesNoEntityTag) {
    create("a");
    stream("a", 1);
    const auto info = registry_.find("a")->info();
    const auto tag = session_tag(info);
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("id").as_string(), tag); // also what is kept for good under this id
    EXPECT_NE(session_tag(info, {.weaving = mapping::kWeavingVersion + 1}), tag);
    EXPECT_NE(session_tag(info, {.rendering = tiles::kRenderingVersion + 1}), tag);
    for (const auto* file :
         {"map.png", "map.pgm", "map.yaml", "tiles/occupancy/0/0/0.png", "tiles/occupancy/0/0/0.bin"}) {
        EXPECT_THAT(std::string(get(fmt::format("/api/v1/sessions/a/{}", file)).get("ETag")), HasSubstr(tag)) << file;
    }
}

TEST_F(ApiTest, BoundsReadAsPeopleWriteThem) {
    create("a");
    stream("a", 1);
    for (const auto* path : {"", "/tiles/occupancy.json", "/trajectory.geojson"}) {
        const std::string text(get(fmt::format("/api/v1/sessions/a{}", path)).body.bytes());
        EXPECT_THAT(text, Not(testing::ContainsRegex("[0-9]\\.[0-9]*(00000000|99999999)"))) << path;
    }
}

TEST_F(ApiTest, OnlyAVersionThatCannotChangeIsKeptForGood) {
    create("a");
    stream("a", 3); // revisions 3, 4, 5 touch the tile
    const auto id = get_json("/api/v1/sessions/a").at("id").as_string();
    const auto kept = [&](const std::string& query) {
        return std::string(get("/api/v1/sessions/a/tiles/occupancy/9/256/255.png?" + query).get("Cache-Control"));
    };
    EXPECT_THAT(kept("v=5"), Not(HasSubstr("immutable")))
        << "a session made anew may reach revision 5 with another map";
    EXPECT_THAT(kept(fmt::format("v=5&id={}", std::string_view(id))), HasSubstr("immutable"));
    EXPECT_EQ(kept("v=4"), "no-cache"); // the tile of revision 4 is no more
    EXPECT_EQ(kept("v=6"), "no-cache"); // not yet
    EXPECT_EQ(kept("v=5&id=0"), "no-cache");
    EXPECT_EQ(kept("id=0"), "no-cache");
}

TEST_F(ApiTest, TilesThatCannotBeAreRefused) {
    create("a");
    const auto status = [&](const std::string& tile) { return get("/api/v1/sessions/a/tiles/" + tile).status; };
    for (const auto* tile :
         {"occupancy/10/0/0.png", "occupancy/-1/0/0.png", "occupancy/9/512/0.png", "occupancy/0/0/1.bin",
          "occupancy/9/0/99999999999999999999.png", "height/0/0/0.png", "height.json"}) {
        EXPECT_EQ(status(tile), Status::not_found) << tile;
    }
    for (const auto* tile :
         {"occupancy/x/0/0.png", "occupancy/0/0.5/0.png", "occupancy/0/0/0x0.png", "occupancy/0/0/0.png?w=1",
          "occupancy/0/0/0.png?v=new", "occupancy/0/0/0.png?v=18446744073709551616", "occupancy/0/%20/0.png"}) {
        EXPECT_EQ(status(tile), Status::bad_request) << tile;
    }
}

TEST_F(ApiTest, EveryAddressOfASessionKnowsWhenThereIsNone) {
    for (const auto* path : {"", "/tiles/occupancy/0/0/0.png", "/tiles/occupancy/0/0/0.bin", "/tiles/occupancy.json",
                             "/changes", "/map.png", "/map.pgm", "/map.yaml", "/digest", "/trajectory.geojson"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/nobody{}", path)), Status::not_found),
                    HasSubstr("there is no session 'nobody'"));
    }
    for (const auto* name : {"nobody",
                             "%23"
                             "12",
                             "%FFno%22body"}) {
        const auto target = fmt::format("/api/v1/sessions/{}", name);
        EXPECT_EQ(detail(ask("DELETE", target), Status::not_found), detail(get(target), Status::not_found));
    }
}

TEST_F(ApiTest, ChangesAreTheTilesTouchedSince) {
    create("a");
    EXPECT_EQ(
        get_json("/api/v1/sessions/a/changes"),
        (boost::json::object{
            {"layer", "occupancy"}, {"since", 0}, {"reset", false}, {"revision", 0}, {"tiles", boost::json::array{}}}));
    stream("a", 3);
    const auto all = get_json("/api/v1/sessions/a/changes?layer=occupancy&since=0");
    EXPECT_EQ(all.at("revision"), 5);
    const auto& changed = all.at("tiles").as_array();
    EXPECT_THAT(changed, testing::Contains(boost::json::value{{"z", 0}, {"x", 0}, {"y", 0}, {"revision", 5}}));
    EXPECT_THAT(changed, testing::Contains(boost::json::value{{"z", 9}, {"x", 256}, {"y", 255}, {"revision", 5}}));
    EXPECT_TRUE(get_json("/api/v1/sessions/a/changes?since=5").at("tiles").as_array().empty());
    EXPECT_EQ(all.at("reset"), false);
    EXPECT_EQ(get_json("/api/v1/sessions/a/changes?since=5").at("reset"), false);
    const auto of_a_session_before = get_json("/api/v1/sessions/a/changes?since=9");
    EXPECT_EQ(of_a_session_before.at("tiles"), all.at("tiles"));
    EXPECT_EQ(of_a_session_before.at("reset"), true);
}

TEST_F(ApiTest, BadChangesAreRefusedByParameter) {
    create("a");
    for (const auto* since : {"x", "-1", "1.5", "", "18446744073709551616"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/a/changes?since={}", since)), Status::bad_request),
                    StartsWith("since is"));
    }
    EXPECT_EQ(get("/api/v1/sessions/a/changes?since=18446744073709551615").status, Status::ok);
    EXPECT_EQ(get("/api/v1/sessions/a/trajectory.geojson?since=18446744073709551616").status, Status::bad_request);
    EXPECT_EQ(get("/api/v1/sessions/a/changes?layer=height").status, Status::not_found);
    EXPECT_THAT(detail(get("/api/v1/sessions/a/changes?until=3"), Status::bad_request), HasSubstr("\"until\""));
}

TEST_F(ApiTest, TileJsonSaysWhereTilesAreInMetres) {
    create("a");
    const auto blank = get_json("/api/v1/sessions/a/tiles/occupancy.json");
    EXPECT_EQ(blank.at("tilejson"), "3.0.0");
    EXPECT_EQ(blank.at("tiles"), (boost::json::array{"/api/v1/sessions/a/tiles/occupancy/{z}/{x}/{y}.png"}));
    EXPECT_EQ(blank.at("vector_layers"), boost::json::array{});
    EXPECT_EQ(blank.at("maxzoom"), 9);
    EXPECT_EQ(blank.at("cell_size"), 0.05);
    EXPECT_NEAR(blank.at("extent").at(0).to_number<double>(), -3276.8, 1e-9);
    EXPECT_EQ(blank.at("frame_id"), "map");
    EXPECT_TRUE(blank.at("bounds_m").is_null());
    stream("a", 1);
    EXPECT_EQ(get_json("/api/v1/sessions/a/tiles/occupancy.json").at("bounds_m").as_array().size(), 4U);
}

TEST_F(ApiTest, MapFilesAreWhatTheySay) {
    create("a");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::not_found); // nothing was seen
    stream("a", 1);
    const auto image = get("/api/v1/sessions/a/map.png");
    EXPECT_EQ(image.get("Content-Type"), "image/png");
    EXPECT_THAT(std::string(image.body.bytes()), StartsWith("\x89PNG"));
    const auto part = get("/api/v1/sessions/a/map.pgm?bbox=0,0,1,0.5");
    EXPECT_THAT(std::string(part.body.bytes()), HasSubstr("20 10\n255\n"));
    const auto yaml = get("/api/v1/sessions/a/map.yaml?layer=occupancy&bbox=-1,-2,1,1");
    EXPECT_EQ(yaml.get("Content-Type"), "application/yaml");
    EXPECT_THAT(std::string(yaml.body.bytes()), AllOf(HasSubstr("image: map.pgm"), HasSubstr("-2")));
    EXPECT_EQ(get("/api/v1/sessions/a/map.png", std::string(image.get("ETag"))).status, Status::not_modified);
}

TEST_F(ApiTest, BadBoxesAreRefused) {
    create("a");
    stream("a", 1);
    for (const auto* box : {"", "1", "0,0,1", "0,0,1,1,1", "0,0,1,x", "0,0,nan,1", "0,0,1e999,1", "0,0,0,0", "1,1,0,0",
                            "0,0,1,", "0,0,1e300,1"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/a/map.png?bbox={}", box)), Status::bad_request),
                    HasSubstr("bbox"))
            << box;
    }
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?bbox=-90000,-90000,90000,90000").status, Status::payload_too_large);
}

TEST_F(ApiTest, HugeMapImagesAreBoundedUntilTheyAreSent) {
    create("a");
    stream("a", 1);
    const std::string huge = "bbox=-75,-75,75,75"; // 9 million pixels
    std::vector<Response> unsent;
    for (const auto* file : {"map.png", "map.pgm"}) {
        unsent.push_back(get(fmt::format("/api/v1/sessions/a/{}?{}", file, huge)));
    }
    for (const auto& response : unsent) EXPECT_EQ(response.status, Status::ok);
    for (const auto* file : {"map.png", "map.pgm"}) {
        const auto refused = get(fmt::format("/api/v1/sessions/a/{}?{}", file, huge));
        EXPECT_EQ(refused.status, Status::service_unavailable);
        EXPECT_EQ(refused.get("Retry-After"), "1");
    }
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::ok) << "a small one is not held up by them";
    EXPECT_EQ(get("/api/v1/sessions/a/map.yaml?" + huge).status, Status::ok);
    const std::string etag(unsent[0].get("ETag"));
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?" + huge, etag).status, Status::not_modified);
    unsent.pop_back();
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?" + huge).status, Status::ok);
}

TEST_F(ApiTest, DigestIsThatOfTheSnapshot) {
    create("a");
    stream("a", 2);
    const auto snapshot = registry_.find("a")->snapshot();
    EXPECT_EQ(
        get_json("/api/v1/sessions/a/digest"),
        (boost::json::object{{"revision", 4}, {"layers", {{"occupancy", mapping::digest_of(snapshot->occupancy)}}}}));
}

TEST_F(ApiTest, TrajectoryIsWhereTheScansWereTaken) {
    create("a");
    EXPECT_TRUE(get_json("/api/v1/sessions/a/trajectory.geojson").at("features").as_array().empty());
    stream("a", 3);
    const auto response = get("/api/v1/sessions/a/trajectory.geojson");
    EXPECT_EQ(response.get("Content-Type"), "application/geo+json");
    const auto whole = boost::json::parse(response.body.bytes());
    EXPECT_EQ(whole.at("revision"), 5);
    EXPECT_EQ(whole.at("features").at(0).at("properties"), (boost::json::object{{"robot", "r1"}, {"points", 3}}));
    EXPECT_EQ(whole.at("features").at(0).at("geometry"),
              (boost::json::value{{"type", "LineString"}, {"coordinates", {{0.5, 1.25}, {1, 1.25}, {1.5, 1.25}}}}));
    const auto newest = get_json("/api/v1/sessions/a/trajectory.geojson?since=4");
    EXPECT_EQ(newest.at("features").at(0).at("geometry"),
              (boost::json::value{{"type", "MultiPoint"},
                                  {"coordinates", boost::json::array{boost::json::array{1.5, 1.25}}}}));
    const auto none = get_json("/api/v1/sessions/a/trajectory.geojson?since=5");
    EXPECT_EQ(none.at("features").at(0).at("geometry").at("coordinates"), boost::json::array{});
    EXPECT_EQ(get_json("/api/v1/sessions/a/trajectory.geojson?since=6"), whole); // of a session before
}

TEST_F(ApiTest, ReadinessFollowsTheServersLife) {
    Api starting(registry_, log_, metrics_, {});
    const auto ready = [&](Api& api) { return answer(api, {.target = "/readyz"}); };
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

TEST_F(ApiTest, ReadinessDoesNotLookAtTheDisk) {
    EXPECT_EQ(get("/readyz").status, Status::ok);
    EXPECT_EQ(log_.looks_at_the_disk(), 0);
    EXPECT_EQ(get("/metrics").status, Status::ok);
    EXPECT_EQ(log_.looks_at_the_disk(), 1);
}

TEST_F(ApiTest, ReadinessNamesAFailedStore) {
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    ask("POST", "/api/v1/sessions", R"({"name":"a"})");
    EXPECT_THAT(std::string(get("/readyz").body.bytes()), HasSubstr("the store failed: the disk is full"));
}

TEST_F(ApiTest, ADamagedSessionSaysSo) {
    ASSERT_TRUE(log_.create_session("no record of a session"));
    session::SessionRegistry registry(log_, pool_.get_executor(), [] { return 0.0; });
    ASSERT_TRUE(registry.recover());
    ASSERT_EQ(registry.damaged().size(), 1U);
    const auto name = registry.damaged().begin()->first; // "#" and its id
    Api api(registry, log_, metrics_, {});
    api.set_recovered();
    const auto path = "/api/v1/sessions/%23" + name.substr(1);
    for (const auto* rest : {"", "/changes", "/map.png", "/tiles/occupancy/0/0/0.png"}) {
        const auto response = answer(api, {.target = path + rest});
        EXPECT_THAT(detail(response, Status::internal_server_error), HasSubstr("could not be recovered"));
        EXPECT_EQ(response.get("Retry-After"), "") << "waiting does not help";
    }
    EXPECT_EQ(answer(api, {.method = "DELETE", .target = path}).status, Status::no_content);
    EXPECT_EQ(answer(api, {.target = path}).status, Status::not_found);
}

TEST_F(ApiTest, DamagedSessionsAreListedAndDoNotHinderTheOthers) {
    create("a");
    ASSERT_TRUE(log_.create_session("no record of a session"));
    session::SessionRegistry registry(log_, pool_.get_executor(), [] { return 0.0; });
    ASSERT_TRUE(registry.recover());
    Api api(registry, log_, metrics_, {});
    api.set_recovered();
    const auto json = [&](std::string target) {
        const auto response = answer(api, {.target = std::move(target)});
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        return boost::json::parse(response.body.bytes());
    };
    const auto all = json("/api/v1/sessions");
    ASSERT_EQ(all.at("sessions").as_array().size(), 2U);
    const auto damaged = all.at("sessions").at(0);
    EXPECT_EQ(damaged.at("name"), "#2");
    EXPECT_EQ(damaged.at("state"), "damaged");
    EXPECT_FALSE(damaged.at("reason").as_string().empty());
    EXPECT_EQ(all.at("sessions").at(1).at("name"), "a");
    EXPECT_EQ(all.at("sessions").at(1).at("state"), "ok");

    const auto first = json("/api/v1/sessions?limit=1");
    EXPECT_EQ(first.at("next"), damaged.at("name"));
    const auto rest =
        json("/api/v1/sessions?after=%23" + std::string(std::string_view(damaged.at("name").as_string()).substr(1)));
    EXPECT_EQ(rest.at("sessions").at(0).at("name"), "a");
    EXPECT_EQ(json("/readyz").at("damaged"), boost::json::array{damaged});
    registry.drain();
}

TEST_F(ApiTest, ASessionThatTakesNoScansSaysSoAndItsMapIsServed) {
    create("a");
    create("b");
    stream("a", 1);
    EXPECT_EQ(get_json("/readyz").at("failed"), boost::json::array{});
    EXPECT_FALSE(get_json("/api/v1/sessions/a").as_object().contains("reason"));
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    registry_.find("a")->submit(links_[0], {scan(2)}, 1);
    links_[0]->wait_for_failure();
    const auto shown = get_json("/api/v1/sessions/a");
    EXPECT_EQ(shown.at("state"), "failed");
    EXPECT_EQ(shown.at("reason"), "the disk is full");
    EXPECT_EQ(shown.at("scans"), 1);
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(0), shown);
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(1).at("state"), "ok");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::ok);
    EXPECT_THAT(std::string(get("/metrics").body.bytes()), HasSubstr("scanloom_sessions_failed 1\n"));

    log_.reopen(); // as when it was not the store that failed
    EXPECT_EQ(get_json("/readyz").at("failed"),
              (boost::json::array{{{"name", "a"}, {"state", "failed"}, {"reason", "the disk is full"}}}));
}

TEST_F(ApiTest, ReadinessTellsWhereRobotsConnect) {
    EXPECT_TRUE(get_json("/readyz").at("robots").at("host").is_null());
    api_.set_robot_port({"192.0.2.7", 7448});
    EXPECT_EQ(get_json("/readyz").at("robots"), (boost::json::object{{"host", "192.0.2.7"}, {"port", 7448}}));
}

TEST_F(ApiTest, MetricsNameNoSession) {
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

/// The address of a route in which every variable has a value.
std::string address_of(const Route& route, std::string_view session) {
    std::string address(route.pattern);
    for (const auto& [name, value] : {std::pair<std::string, std::string_view>{"{session}", session},
                                      {"{layer}", "occupancy"},
                                      {"{file}", "x.js"},
                                      {"{z}", "0"},
                                      {"{x}", "0"},
                                      {"{y}", "0"}}) {
        if (const auto at = address.find(name); at != std::string::npos) address.replace(at, name.size(), value);
    }
    return address;
}

TEST_F(ApiTest, EveryOperationAnswersAsItIsDescribed) {
    create("a");
    stream("a", 2);
    Api starting(registry_, log_, metrics_, {});
    for (const auto& route : routes()) {
        if (route.operation == Operation::kDeleteSession) continue; // at the end
        for (const std::string session : {"a", "nobody"}) {
            const auto address = address_of(route, session);
            for (const auto* query : {"", "?odd=1", "?since=x", "?v=x", "?bbox=x", "?layer=height"}) {
                ask(std::string(route.method), address + query, R"({"name":"b"})"); // asks openapi.json, too
            }
            answer(starting,
                   {.method = std::string(route.method), .target = address, .content_type = "application/json"});
        }
    }
    for (const auto* session : {"a", "a", "a?odd=1"}) ask("DELETE", fmt::format("/api/v1/sessions/{}", session));
    answer(starting, {.method = "DELETE", .target = "/api/v1/sessions/a"});
}

TEST_F(ApiTest, RoutesThatAreNotAreProblems) {
    EXPECT_EQ(get("/api/v2/sessions").status, Status::not_found);
    EXPECT_EQ(get("no path").status, Status::bad_request);
    const auto refused = ask("PATCH", "/api/v1/sessions/a");
    EXPECT_EQ(refused.status, Status::method_not_allowed);
    EXPECT_EQ(refused.get("Allow"), "GET, HEAD, DELETE");
}

TEST_F(ApiTest, TheRootExplainsAMissingViewer) {
    EXPECT_EQ(get("/?session=a").status, Status::not_found);
    EXPECT_THAT(std::string(get("/").body.bytes()), HasSubstr("was not built"));
    EXPECT_EQ(get("/assets/x.js").status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
