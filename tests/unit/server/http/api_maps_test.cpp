#include "tests/unit/server/http/api_fixture.hpp"

#include "core/mapping/snapshot.hpp"

#include <boost/json/array.hpp>

/// Files, digests and trajectories of a whole map.
namespace scanloom::http {
namespace {

TEST_F(ApiTest, MapFilesHaveTheirFormats) {
    create("a");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::not_found); // no cell was observed
    stream("a", 1);
    const auto image = get("/api/v1/sessions/a/map.png");
    EXPECT_EQ(image.get("Content-Type"), "image/png");
    EXPECT_THAT(std::string(image.body.bytes()), StartsWith("\x89PNG"));
    const auto part = get("/api/v1/sessions/a/map.pgm?bbox=0,0,1,0.5");
    EXPECT_THAT(std::string(part.body.bytes()), HasSubstr("20 10\n255\n"));
    const auto yaml = get("/api/v1/sessions/a/map.yaml?layer=occupancy&bbox=-1,-2,1,1");
    EXPECT_EQ(yaml.get("Content-Type"), "application/yaml");
    EXPECT_THAT(std::string(yaml.body.bytes()), AllOf(HasSubstr("image: map.pgm"), HasSubstr("-2")));
    const auto world = get("/api/v1/sessions/a/map.pgw?bbox=-1,-2,1,1");
    EXPECT_EQ(world.body.bytes(), "0.05\n0\n0\n-0.05\n-0.975\n0.975\n");
    EXPECT_EQ(get("/api/v1/sessions/a/map.png", std::string(image.get("ETag"))).status, Status::not_modified);
}

TEST_F(ApiTest, InvalidBboxIsRefused) {
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

TEST_F(ApiTest, HugeMapImagesHoldAPermitUntilSent) {
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
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::ok) << "a small image does not wait for them";
    EXPECT_EQ(get("/api/v1/sessions/a/map.yaml?" + huge).status, Status::ok);
    const std::string etag(unsent[0].get("ETag"));
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?" + huge, etag).status, Status::not_modified);
    unsent.pop_back();
    EXPECT_EQ(get("/api/v1/sessions/a/map.png?" + huge).status, Status::ok);
}

TEST_F(ApiTest, DigestEqualsThatOfTheSnapshot) {
    create("a");
    stream("a", 2);
    const auto snapshot = registry_.find("a")->snapshot();
    boost::json::object layers;
    for (const auto layer : mapping::kLayers) layers[mapping::name_of(layer)] = mapping::digest_of(*snapshot, layer);
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest"), (boost::json::object{{"revision", 4}, {"layers", layers}}));
    EXPECT_EQ(get_json("/api/v1/sessions/a/digest?layer=himm"),
              (boost::json::object{{"revision", 4}, {"layers", {{"himm", layers.at("himm")}}}}));
}

TEST_F(ApiTest, TrajectoryHasThePosesOfTheScans) {
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
    EXPECT_EQ(get_json("/api/v1/sessions/a/trajectory.geojson?since=6"), whole); // of an earlier session
}

TEST_F(ApiTest, TrajectoryHasTimesOnRequestOnly) {
    create("a");
    std::vector<Scan> scans = {scan(1), scan(2), scan(3)};
    scans[0].stamp = 976052857.33794796;
    scans[0].pose->yaw = -0.000004; // rounds to 0, not to -0
    scans[1].stamp = 976052857.5;
    scans[1].pose->yaw = 3.14159;
    scans[2].pose->yaw = -1.23456;
    stream("a", "r1", std::move(scans));
    const std::string path = "/api/v1/sessions/a/trajectory.geojson";
    const std::string plain(get(path).body.bytes());
    EXPECT_EQ(get(path + "?times=false").body.bytes(), plain);
    EXPECT_THAT(plain, Not(HasSubstr("stamps")));
    EXPECT_THAT(get(path + "?times=true").body.bytes(),
                HasSubstr(R"("properties":{"robot":"r1","points":3,"revisions":[3,4,5],)"
                          R"("stamps":[976052857.337948,976052857.5,103],"yaws":[0,3.1416,-1.2346]},"geometry":)"));
    const auto newest = get_json(path + "?times=true&since=4").at("features").at(0).at("properties");
    EXPECT_EQ(newest,
              boost::json::parse(R"({"robot":"r1","points":1,"revisions":[5],"stamps":[103],"yaws":[-1.2346]})"));
    const auto none = get_json(path + "?times=true&since=5").at("features").at(0).at("properties");
    EXPECT_EQ(none, boost::json::parse(R"({"robot":"r1","points":0,"revisions":[],"stamps":[],"yaws":[]})"));
}

TEST_F(ApiTest, LongTrajectoryIncludesPositionsNotInMemory) {
    create("a");
    constexpr std::size_t kScans = mapping::kTrajectoryKept + 2000;
    std::vector<Scan> scans;
    for (std::size_t n = 0; n < kScans; ++n) {
        scans.push_back(scan(n + 1));
        scans.back().pose->x = static_cast<double>(n % 16) / 4;
    }
    stream("a", "r1", std::move(scans));
    ASSERT_GT(registry_.find("a")->snapshot()->robots.at(0).trajectory.begin(), 0U)
        << "otherwise this test checks nothing";
    const auto whole = get_json("/api/v1/sessions/a/trajectory.geojson?times=true");
    EXPECT_EQ(whole.at("revision"), kScans + 2);
    const auto& path = whole.at("features").at(0);
    EXPECT_EQ(path.at("properties").at("points"), kScans);
    EXPECT_EQ(path.at("properties").at("revisions").as_array().size(), kScans);
    const auto without_times = get_json("/api/v1/sessions/a/trajectory.geojson");
    EXPECT_EQ(without_times.at("features").at(0).at("geometry"), path.at("geometry"));
    ASSERT_EQ(path.at("geometry").at("coordinates").as_array().size(), kScans);
    for (std::size_t n = 0; n < kScans; ++n) {
        const auto& point = path.at("geometry").at("coordinates").at(n);
        ASSERT_EQ(point.at(0).to_number<double>(), static_cast<double>(n % 16) / 4) << n;
    }
}

TEST_F(ApiTest, InvalidTimesAreRefused) {
    create("a");
    for (const auto* times : {"", "1", "yes", "TRUE"}) {
        const auto refused = get(fmt::format("/api/v1/sessions/a/trajectory.geojson?times={}", times));
        EXPECT_THAT(detail(refused, Status::bad_request), StartsWith("times is"));
    }
}

} // namespace
} // namespace scanloom::http
