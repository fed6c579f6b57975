#include "core/landmarks/landmark.hpp"
#include "tests/support/room_scans.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>

#include <algorithm>

namespace scanloom::http {
namespace {

/// A robot that drives around in a room with furniture.
class ApiLandmarksTest : public ApiTest {
protected:
    void SetUp() override { create("a"); }

    /// Sends scans `first` to `last` of the tour and waits until they are integrated.
    void drive(std::uint64_t first, std::uint64_t last) {
        const auto session = registry_.find("a");
        const auto link = join("a", "r1", last);
        session->submit(link, testing_support::reference_laser(), 0);
        session->submit(link,
                        {round_.begin() + static_cast<std::ptrdiff_t>(first) - 1,
                         round_.begin() + static_cast<std::ptrdiff_t>(last)},
                        1);
        link->wait();
    }

    boost::json::value landmarks(const std::string& query = "") {
        return get_json("/api/v1/sessions/a/landmarks.geojson" + (query.empty() ? "" : "?" + query));
    }

    const std::vector<Scan> round_ = testing_support::room_scans(240);
};

std::vector<std::uint64_t> ids_of(const boost::json::value& collection) {
    std::vector<std::uint64_t> ids;
    for (const auto& feature : collection.at("features").as_array()) {
        ids.push_back(feature.at("id").to_number<std::uint64_t>());
    }
    return ids;
}

TEST_F(ApiLandmarksTest, SessionWithoutScansHasNone) {
    EXPECT_EQ(get("/api/v1/sessions/a/landmarks.geojson").body.bytes(),
              R"({"type":"FeatureCollection","frame_id":"map","units":"m","revision":0,"reset":false,"captures":0,)"
              R"("landmarks":0,"tolerance":0.25,"persistence":null,"stability":null,"continuity":null,"features":[]})");
}

TEST_F(ApiLandmarksTest, PositionsMatchTheObjectsOfTheRoom) {
    drive(1, 240);
    const auto found = landmarks();
    EXPECT_EQ(found.at("revision"), 242);
    EXPECT_GT(found.at("captures").to_number<int>(), 10);
    for (const char* mean : {"persistence", "stability", "continuity"}) {
        EXPECT_GT(found.at(mean).to_number<double>(), 0.0) << mean;
        EXPECT_LE(found.at(mean).to_number<double>(), 1.0) << mean;
    }
    EXPECT_EQ(ids_of(found).size(), found.at("landmarks").to_number<std::size_t>());
    EXPECT_TRUE(std::ranges::is_sorted(ids_of(found)));
    for (const auto& feature : found.at("features").as_array()) {
        const auto& of = feature.at("properties");
        EXPECT_GE(of.at("seen").to_number<int>(), 1);
        EXPECT_GE(of.at("points").to_number<int>(), 5);
        EXPECT_LE(of.at("first").to_number<int>(), of.at("last").to_number<int>());
        const auto& at = feature.at("geometry").at("coordinates").as_array();
        EXPECT_LE(std::abs(at.at(0).to_number<double>()), 5.0) << "in the room";
        EXPECT_LE(std::abs(at.at(1).to_number<double>()), 5.0);
    }
}

TEST_F(ApiLandmarksTest, UpdatesSinceARevisionCompleteTheEarlierAnswer) {
    drive(1, 100);
    const auto before = landmarks();
    drive(101, 240);
    const auto now = landmarks();
    const auto since = landmarks("since=" + std::to_string(before.at("revision").to_number<int>()));
    EXPECT_EQ(since.at("revision"), now.at("revision"));
    EXPECT_EQ(since.at("landmarks"), now.at("landmarks"));
    EXPECT_LT(ids_of(since).size(), ids_of(now).size());
    auto together = before.at("features").as_array();
    for (const auto& feature : since.at("features").as_array()) {
        const auto known =
            std::ranges::find_if(together, [&](const auto& other) { return other.at("id") == feature.at("id"); });
        if (known == together.end()) {
            together.push_back(feature);
        } else {
            *known = feature;
        }
    }
    EXPECT_EQ(together, now.at("features").as_array());
    EXPECT_EQ(ids_of(landmarks("since=242")).size(), 0U);
    EXPECT_EQ(landmarks("since=242").at("reset"), false);
}

TEST_F(ApiLandmarksTest, RecreatedSessionReturnsAllWithReset) {
    drive(1, 60);
    const auto all = landmarks();
    const auto beyond = landmarks("since=100000");
    EXPECT_EQ(beyond.at("reset"), true);
    EXPECT_EQ(beyond.at("features"), all.at("features"));
}

TEST_F(ApiLandmarksTest, BboxAndSeenMinFilterLandmarks) {
    drive(1, 240);
    const auto all = landmarks();
    std::size_t inside = 0;
    std::size_t often = 0;
    for (const auto& feature : all.at("features").as_array()) {
        const auto& at = feature.at("geometry").at("coordinates").as_array();
        const double x = at.at(0).to_number<double>();
        const double y = at.at(1).to_number<double>();
        inside += x >= -2 && x <= 5.5 && y >= 0 && y <= 5.5 ? 1 : 0;
        often += feature.at("properties").at("seen").to_number<int>() >= 3 ? 1 : 0;
    }
    EXPECT_EQ(ids_of(landmarks("bbox=-2,0,5.5,5.5")).size(), inside);
    EXPECT_EQ(ids_of(landmarks("seen_min=3")).size(), often);
    EXPECT_GT(inside, 0U);
    EXPECT_LT(inside, ids_of(all).size());
    EXPECT_GT(often, 0U);
    EXPECT_LT(often, ids_of(all).size());
}

TEST_F(ApiLandmarksTest, InvalidParametersAreNamed) {
    const std::string path = "/api/v1/sessions/a/landmarks.geojson?";
    for (const auto& [query, what] : {
             std::pair{"seen_min=0", "seen_min is \"0\"; a whole number from 1 to 4294967295 is needed"},
             std::pair{"seen_min=-1", "seen_min is \"-1\""},
             std::pair{"seen_min=often", "seen_min is \"often\""},
             std::pair{"bbox=1,2,3", "bbox is \"1,2,3\""},
             std::pair{"bbox=1,2,0,3", "bbox is empty"},
             std::pair{"since=now", "since is \"now\""},
             std::pair{"colour=red", "the parameter \"colour\" is unknown"},
         }) {
        EXPECT_THAT(detail(get(path + query), Status::bad_request), HasSubstr(what));
    }
    EXPECT_EQ(get("/api/v1/sessions/none/landmarks.geojson").status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
