#include "tests/unit/server/http/api_fixture.hpp"

#include "server/tiles/tile.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::http {
namespace {

const std::string kNative = "/api/v1/sessions/a/tiles/occupancy/9/256/255.png";
const std::string kWhole = "/api/v1/sessions/a/tiles/occupancy/0/0/0.png";

/// Tiles that need no thread other than an I/O thread.
class KeptTilesTest : public ApiTest {
protected:
    /// Returns the response if an I/O thread computed it.
    std::optional<Response> at_once(std::string target, std::string if_none_match = "") {
        auto asked = api_.ask({.target = std::move(target), .if_none_match = std::move(if_none_match)});
        return asked.work.empty() ? std::move(asked.response) : std::nullopt;
    }

    /// Returns the classes of work that a tile needs.
    std::vector<WorkClass> work(std::string target) { return api_.ask({.target = std::move(target)}).work; }

    double counted(const std::string& name) {
        const std::string text(get("/metrics").body.bytes());
        const auto at = text.find("\n" + name + " ");
        return at == std::string::npos ? -1.0 : std::stod(text.substr(at + name.size() + 2));
    }
};

TEST_F(KeptTilesTest, CachedTileEqualsTheRenderedOne) {
    create("a");
    stream("a", 1);
    EXPECT_FALSE(at_once(kNative));
    const auto made = get(kNative);
    const auto kept = at_once(kNative);
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->body.bytes().data(), made.body.bytes().data()) << "the same bytes, not a copy";
    EXPECT_EQ(kept->fields, made.fields);
    stream("a", 2, 2);
    EXPECT_FALSE(at_once(kNative)) << "which has changed";
}

TEST_F(KeptTilesTest, CurrentEmptyAndInvalidTilesAreAnsweredWithoutRendering) {
    create("a");
    stream("a", 1);
    EXPECT_EQ(at_once(kNative, std::string(get(kNative).get("ETag")))->status, Status::not_modified);
    EXPECT_EQ(at_once("/api/v1/sessions/a/tiles/occupancy/9/0/0.png")->status, Status::ok);
    EXPECT_EQ(at_once("/api/v1/sessions/a/tiles/occupancy/10/0/0.png")->status, Status::not_found);
    EXPECT_EQ(at_once("/api/v1/sessions/b/tiles/occupancy/9/0/0.bin")->status, Status::not_found);
}

TEST_F(KeptTilesTest, OnlyTheFirstRenderingOfAWholeMapIsASurvey) {
    create("a");
    stream("a", 1);
    EXPECT_THAT(work(kNative), testing::ElementsAre(WorkClass::kQueries));
    EXPECT_THAT(work(kWhole), testing::ElementsAre(WorkClass::kWholeMaps));
    stream("a", 2, 2);
    EXPECT_THAT(work(kWhole), testing::ElementsAre(WorkClass::kQueries));
}

TEST_F(KeptTilesTest, HitsMissesAndBytesAreCounted) {
    create("a");
    stream("a", 1);
    static_cast<void>(get(kNative));
    static_cast<void>(get(kNative));
    static_cast<void>(get(kNative));
    EXPECT_EQ(counted("scanloom_tile_cache_misses_total"), 1.0);
    EXPECT_EQ(counted("scanloom_tile_cache_hits_total"), 2.0);
    EXPECT_EQ(counted("scanloom_tile_cache_tiles"), 1.0);
    EXPECT_GT(counted("scanloom_tile_cache_bytes"), static_cast<double>(get(kNative).body.bytes().size()));
}

TEST_F(KeptTilesTest, DeletedSessionLeavesNoTiles) {
    create("a");
    create("b");
    stream("a", 1);
    stream("b", 1);
    for (const auto* session : {"a", "b"}) {
        static_cast<void>(get(fmt::format("/api/v1/sessions/{}/tiles/occupancy/0/0/0.png", session)));
    }
    const double tiles = counted("scanloom_tile_cache_tiles");
    EXPECT_EQ(tiles, 4.0) << "a PNG and the pixels of each";
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a").status, Status::no_content);
    EXPECT_EQ(counted("scanloom_tile_cache_tiles"), 2.0);
    EXPECT_TRUE(at_once("/api/v1/sessions/b/tiles/occupancy/0/0/0.png"));
}

TEST_F(KeptTilesTest, CacheIsNotUsedBeforeRecoveryEnds) {
    TestApi fresh(registry_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {});
    const auto asked = fresh.ask({.target = kNative});
    EXPECT_EQ(asked.response->status, Status::service_unavailable);
    EXPECT_TRUE(asked.work.empty());
}

/// The sanitizers check the threads for races; this test checks that every response is a possible one.
TEST_F(KeptTilesTest, ConcurrentRequestsDuringScansAndDeletionSucceed) {
    create("a");
    create("doomed");
    stream("a", 1);
    stream("doomed", 1);
    std::atomic<bool> over = false;
    std::atomic<int> wrong = 0;
    std::vector<std::thread> viewers;
    for (unsigned n = 0; n < 6; ++n) {
        viewers.emplace_back([&, n] {
            const std::array names = {"a", "doomed"};
            for (unsigned round = n; !over; ++round) {
                const auto zoom = round % 10;
                const auto key = tiles::tile_of({0, 0}, zoom);
                const Request request{.target =
                                          fmt::format("/api/v1/sessions/{}/tiles/{}/{}/{}/{}.{}", names[round % 2],
                                                      round % 3 == 0 ? "classification" : "occupancy", zoom, key.x,
                                                      key.y, round % 5 == 0 ? "bin" : "png")};
                const auto status = api_.answer(request).status;
                const bool may_be_gone = round % 2 == 1;
                if (status != Status::ok && !(may_be_gone && status == Status::not_found)) ++wrong;
            }
        });
    }
    for (std::uint64_t seq = 2; seq <= 40; ++seq) {
        stream("a", seq, seq);
        if (seq != 20) continue;
        EXPECT_EQ(ask("DELETE", "/api/v1/sessions/doomed").status, Status::no_content);
    }
    over = true;
    for (auto& viewer : viewers) viewer.join();
    EXPECT_EQ(wrong, 0);
    const auto snapshot = registry_.find("a")->snapshot();
    const auto expected = tiles::tile_codes(*snapshot, mapping::Layer::kOccupancy, {0, 0, 0});
    const auto shown = get("/api/v1/sessions/a/tiles/occupancy/0/0/0.bin");
    EXPECT_TRUE(std::ranges::equal(shown.body.bytes(), *expected,
                                   [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }));
}

} // namespace
} // namespace scanloom::http
