#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/asio/post.hpp>

#include <future>
#include <memory>
#include <thread>
#include <vector>

/// Sessions that are not in memory, over HTTP.
namespace scanloom::http {
namespace {

class ApiEvictedSessionsTest : public ApiTest {
protected:
    /// A session with some scans that was evicted from memory.
    void SetUp() override {
        create("a");
        stream("a", 5);
        shown_ = get_json("/api/v1/sessions/a").as_object();
        tile_ = get(kTile);
        registry_.find("a")->leave(links_.back());
        while (registry_.listed("a")->session) {
            clock_ = clock_.load() + std::chrono::hours(1);
            registry_.tidy();
            std::this_thread::yield();
        }
    }

    static Request request_for(const std::string& target) {
        Request request;
        request.method = "GET";
        request.target = target;
        return request;
    }

    static constexpr const char* kTile = "/api/v1/sessions/a/tiles/occupancy/9/256/255.png";
    boost::json::object shown_;
    Response tile_;
};

TEST_F(ApiEvictedSessionsTest, AreListedWithoutBeingLoaded) {
    auto expected = shown_;
    expected["loaded"] = false;
    expected["main_bounds"] = nullptr; // these counts are computed from the map
    expected["robots"].at(0).as_object()["connected"] = false;
    EXPECT_EQ(get_json("/api/v1/sessions/a"), expected);
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(0), expected);
    EXPECT_FALSE(registry_.listed("a")->session);
    const auto metrics = std::string(get("/metrics").body.bytes());
    EXPECT_THAT(metrics, HasSubstr("scanloom_sessions 1\n"));
    EXPECT_THAT(metrics, HasSubstr("scanloom_sessions_loaded 0\n"));
    EXPECT_THAT(metrics, HasSubstr("scanloom_map_memory_bytes 0\n"));
}

TEST_F(ApiEvictedSessionsTest, LoadWithoutBlockingIoThreads) {
    std::promise<void> go_on;
    const auto gone_on = go_on.get_future().share();
    std::vector<std::shared_ptr<TestApi::Running>> waiting;
    for (int thread = 0; thread < 2; ++thread) boost::asio::post(pool_, [gone_on] { gone_on.wait(); });
    for (const char* target : {kTile, "/api/v1/sessions/a/digest", "/api/v1/sessions/a/live"}) {
        waiting.push_back(api_.start(request_for(target)));
        api_.poll(*waiting.back()); // returns, although no thread is free to load the session
        EXPECT_FALSE(waiting.back()->done) << target;
    }
    EXPECT_FALSE(registry_.listed("a")->session);
    go_on.set_value();
    for (const auto& asked : waiting) {
        while (!asked->done) api_.poll(*asked);
    }
    EXPECT_EQ(waiting.front()->asked.response->body.bytes(), tile_.body.bytes());
    EXPECT_EQ(waiting.at(1)->asked.response->status, Status::ok);
    EXPECT_TRUE(api_.ask(request_for(kTile)).work.empty());
    const auto again = get(kTile);
    EXPECT_EQ(again.get("ETag"), tile_.get("ETag"));
    EXPECT_EQ(again.body.bytes(), tile_.body.bytes());
    auto expected = shown_;
    expected["robots"].at(0).as_object()["connected"] = false;
    EXPECT_EQ(get_json("/api/v1/sessions/a"), expected);
}

TEST_F(ApiEvictedSessionsTest, AreDeletedWithoutBeingLoaded) {
    EXPECT_EQ(ask("DELETE", "/api/v1/sessions/a").status, Status::no_content);
    EXPECT_EQ(get("/api/v1/sessions/a").status, Status::not_found);
    EXPECT_TRUE(log_.sessions()->empty());
}

} // namespace
} // namespace scanloom::http
