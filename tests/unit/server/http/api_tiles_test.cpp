#include "tests/unit/server/http/api_fixture.hpp"

#include "server/http/handlers/lookup.hpp"
#include "server/tiles/tile.hpp"

#include <boost/json/array.hpp>

/// Tiles, their versions and their changes.
namespace scanloom::http {
namespace {

TEST_F(ApiTest, TilesShowTheMap) {
    create("a");
    stream("a", 3);
    const auto snapshot = registry_.find("a")->snapshot();
    const auto bytes = get("/api/v1/sessions/a/tiles/occupancy/9/256/255.bin");
    EXPECT_EQ(bytes.get("Content-Type"), "application/octet-stream");
    ASSERT_EQ(bytes.body.bytes().size(), 65'536U);
    const auto expected = tiles::tile_codes(*snapshot, mapping::Layer::kOccupancy, {9, 256, 255});
    EXPECT_TRUE(std::equal(expected->begin(), expected->end(), bytes.body.bytes().begin(),
                           [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
    const auto image = get("/api/v1/sessions/a/tiles/occupancy/0/0/0.png");
    EXPECT_EQ(image.get("Content-Type"), "image/png");
    EXPECT_THAT(std::string(image.body.bytes()), StartsWith("\x89PNG"));
    EXPECT_EQ(get("/api/v1/sessions/a/tiles/occupancy/9/0/0.png").status, Status::ok); // never touched
}

TEST_F(ApiTest, UnchangedTileIsNotModified) {
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

TEST_F(ApiTest, ProgramVersionChangesEntityTags) {
    create("a");
    stream("a", 1);
    const auto info = registry_.find("a")->info();
    const auto tag = session_tag(info);
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("id").as_string(),
              tag); // also responses that are cached forever under this id
    EXPECT_NE(session_tag(info, {.projection = mapping::kProjectionVersion + 1}), tag);
    EXPECT_NE(session_tag(info, {.rendering = tiles::kRenderingVersion + 1}), tag);
    for (const auto* file :
         {"map.png", "map.pgm", "map.yaml", "tiles/occupancy/0/0/0.png", "tiles/occupancy/0/0/0.bin"}) {
        EXPECT_THAT(std::string(get(fmt::format("/api/v1/sessions/a/{}", file)).get("ETag")), HasSubstr(tag)) << file;
    }
}

TEST_F(ApiTest, CoordinatesHaveNoRoundingNoise) {
    create("a");
    stream("a", 1);
    for (const auto* path : {"", "/tiles/occupancy.json", "/trajectory.geojson"}) {
        const std::string text(get(fmt::format("/api/v1/sessions/a{}", path)).body.bytes());
        EXPECT_THAT(text, Not(testing::ContainsRegex("[0-9]\\.[0-9]*(00000000|99999999)"))) << path;
    }
}

TEST_F(ApiTest, OnlyCurrentRevisionsAreImmutable) {
    create("a");
    stream("a", 3); // revisions 3, 4, 5 touch the tile
    const auto id = get_json("/api/v1/sessions/a").at("id").as_string();
    const auto kept = [&](const std::string& query) {
        return std::string(get("/api/v1/sessions/a/tiles/occupancy/9/256/255.png?" + query).get("Cache-Control"));
    };
    EXPECT_THAT(kept("v=5"), Not(HasSubstr("immutable")))
        << "a recreated session may reach revision 5 with another map";
    EXPECT_THAT(kept(fmt::format("v=5&id={}", std::string_view(id))), HasSubstr("immutable"));
    EXPECT_EQ(kept("v=4"), "no-cache"); // the tile of revision 4 no longer exists
    EXPECT_EQ(kept("v=6"), "no-cache"); // not yet
    EXPECT_EQ(kept("v=5&id=0"), "no-cache");
    EXPECT_EQ(kept("id=0"), "no-cache");
}

TEST_F(ApiTest, InvalidTileKeysAreRefused) {
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

TEST_F(ApiTest, ChangesListTilesChangedSinceARevision) {
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

TEST_F(ApiTest, InvalidChangesParametersAreNamed) {
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

TEST_F(ApiTest, TileJsonHasBoundsInMetres) {
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

} // namespace
} // namespace scanloom::http
