#include "tests/unit/server/http/api_fixture.hpp"

#include "server/tiles/difference.hpp"

#include <boost/json/array.hpp>

namespace scanloom::http {
namespace {

class ApiDifferenceTest : public ApiTest {
protected:
    ApiDifferenceTest() {
        create("a");
        stream("a", 5);
    }

    /// Returns the id of a finished replay job.
    std::string finished_job(const std::string& body) {
        const auto response = ask("POST", "/api/v1/sessions/a/weave", body);
        const std::string id(boost::json::parse(response.body.bytes()).at("id").as_string());
        finish_weave("a", id);
        return id;
    }

    static std::string at(const std::string& query) { return "/api/v1/sessions/a/difference?" + query; }
    static std::string image_at(const std::string& query) { return "/api/v1/sessions/a/difference.png?" + query; }
};

TEST_F(ApiDifferenceTest, EqualsTheComparisonOfTheMaps) {
    const auto coarse = finished_job(R"({"cell_size":0.1})");
    const auto early = finished_job(R"({"until":4})");
    const auto maps_of = [&](const std::string& id) {
        return weaves_.find(registry_.find("a")->info().id, id)->maps();
    };
    const tiles::ComparedMaps maps{*maps_of(coarse), *maps_of(early)};
    const auto frame = tiles::difference_frame(maps, std::nullopt).value();
    const auto sums = tiles::compare(maps, frame);
    const auto json = get_json(at(fmt::format("weave={}&with={}", coarse, early)));
    EXPECT_EQ(json.at("layer"), "occupancy");
    EXPECT_EQ(json.at("a"), (boost::json::object{{"weave", coarse}, {"revision", 7}, {"cell_size", 0.1}}));
    EXPECT_EQ(json.at("b"), (boost::json::object{{"weave", early}, {"revision", 4}, {"cell_size", 0.05}}));
    EXPECT_EQ(json.at("cell_size"), 0.05);
    EXPECT_EQ(json.at("width"), frame.width());
    EXPECT_EQ(json.at("height"), frame.height());
    EXPECT_NEAR(json.at("bounds").at("max_x").to_number<double>(), frame.cells.i_end * 0.05, 1e-6);
    for (std::size_t n = 0; n < sums.cells.size(); ++n) {
        const auto name = tiles::kDifferenceNames[n];
        EXPECT_EQ(json.at("cells").as_object().at(name).to_number<std::uint64_t>(), sums.cells[n]) << name;
        EXPECT_NEAR(json.at("areas").as_object().at(name).to_number<double>(),
                    static_cast<double>(sums.cells[n]) * 0.0025, 1e-6);
    }
    const auto known = static_cast<double>(sums.known);
    EXPECT_NEAR(json.at("agreement").to_number<double>(), static_cast<double>(sums.agreeing) / known, 1e-12);
    EXPECT_NEAR(json.at("mean_difference").to_number<double>(), sums.difference / known, 1e-12);
    EXPECT_GT(sums.known, 1000U);
}

TEST_F(ApiDifferenceTest, MissingParameterSelectsTheSessionsMap) {
    const auto early = finished_job(R"({"until":4})");
    const auto later = get_json(at("weave=" + early));
    EXPECT_EQ(later.at("a").at("weave").as_string(), early);
    EXPECT_EQ(later.at("b"), (boost::json::object{{"weave", nullptr}, {"revision", 7}, {"cell_size", 0.05}}));
    EXPECT_EQ(later.at("cells").at("only_a"), 0);
    EXPECT_GT(later.at("cells").at("only_b").as_int64(), 100);
    const auto turned = get_json(at("with=" + early));
    EXPECT_EQ(turned.at("a").at("weave"), nullptr);
    EXPECT_EQ(turned.at("cells").at("only_a"), later.at("cells").at("only_b"));
}

TEST_F(ApiDifferenceTest, EqualMapsHaveNoDifference) {
    const auto same = finished_job("{}");
    for (const auto* layer : {"occupancy", "himm", "classification"}) {
        const auto json = get_json(at(fmt::format("weave={0}&with={0}&layer={1}", same, layer)));
        EXPECT_EQ(json.at("layer"), layer);
        EXPECT_EQ(json.at("agreement").to_number<double>(), 1.0);
        EXPECT_EQ(json.at("cells").at("only_a"), 0);
        EXPECT_EQ(json.at("cells").at("free_occupied"), 0);
        EXPECT_EQ(json.at("mean_difference").is_null(), layer != std::string_view("occupancy"));
    }
}

TEST_F(ApiDifferenceTest, UnknownAreaHasNoAgreement) {
    const auto json = get_json(at("weave=" + finished_job("{}") + "&bbox=50,50,51,50.5"));
    EXPECT_EQ(json.at("width"), 20);
    EXPECT_EQ(json.at("height"), 10);
    EXPECT_EQ(json.at("cells").at("neither"), 200);
    EXPECT_EQ(json.at("areas").at("neither"), 0.5);
    EXPECT_TRUE(json.at("agreement").is_null());
    EXPECT_TRUE(json.at("mean_difference").is_null());
}

TEST_F(ApiDifferenceTest, ImageHasBoundsAndEntityTag) {
    const auto early = finished_job(R"({"until":4})");
    const auto image = get(image_at("weave=" + early + "&bbox=-1,-0.5,2,3"));
    EXPECT_EQ(image.status, Status::ok);
    EXPECT_EQ(image.get("Content-Type"), "image/png");
    EXPECT_EQ(image.get("Scanloom-Bounds"), "-1,-0.5,2,3");
    EXPECT_THAT(std::string(image.body.bytes()), StartsWith("\x89PNG"));
    const std::string etag(image.get("ETag"));
    EXPECT_EQ(get(image_at("weave=" + early + "&bbox=-1,-0.5,2,3"), etag).status, Status::not_modified);
    EXPECT_NE(get(image_at("with=" + early)).get("ETag"), etag);
    stream("a", "r2", {scan(1)});
    EXPECT_EQ(get(image_at("weave=" + early + "&bbox=-1,-0.5,2,3"), etag).status, Status::ok) << "the map has grown";
}

TEST_F(ApiDifferenceTest, InvalidComparisonsAreRefused) {
    const auto id = finished_job("{}");
    for (const auto* file : {"difference", "difference.png"}) {
        const auto asked = [&](const std::string& query) {
            return get(fmt::format("/api/v1/sessions/a/{}?{}", file, query));
        };
        EXPECT_THAT(detail(asked("layer=himm"), Status::bad_request), HasSubstr("weave=, with= or both"));
        EXPECT_THAT(detail(asked("with=0123456789abcdef"), Status::not_found), HasSubstr("no replay job"));
        EXPECT_EQ(asked("weave=" + id + "&with=x").status, Status::not_found);
        EXPECT_EQ(asked("weave=" + id + "&layer=height").status, Status::not_found);
        EXPECT_EQ(asked("weave=" + id + "&layer=sonar").status, Status::not_found) << "there is none";
        EXPECT_EQ(asked("weave=" + id + "&bbox=1,2,3").status, Status::bad_request);
        EXPECT_EQ(asked("weave=" + id + "&until=3").status, Status::bad_request);
        EXPECT_EQ(asked("weave=" + id + "&bbox=0,0,1000,1000").status, Status::payload_too_large);
        EXPECT_EQ(get(fmt::format("/api/v1/sessions/b/{}?weave={}", file, id)).status, Status::not_found);
    }
}

TEST_F(ApiDifferenceTest, AtMostTwoHugeImagesAtATime) {
    const auto huge = image_at("weave=" + finished_job("{}") + "&bbox=-75,-75,75,75"); // 9 million pixels
    const auto first = get(huge);
    const auto second = get(huge);
    EXPECT_EQ(second.status, Status::ok);
    EXPECT_EQ(get(huge).status, Status::service_unavailable);
    EXPECT_EQ(get(huge, std::string(first.get("ETag"))).status, Status::not_modified);
}

} // namespace
} // namespace scanloom::http
