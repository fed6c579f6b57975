#include "server/live/landmark_hub.hpp"

#include "tests/support/http_client.hpp"
#include "tests/support/live_client.hpp"
#include "tests/support/live_replay.hpp"
#include "tests/unit/server/live/live_server.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::live {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::HttpClient;
using testing_support::LiveClient;
using testing_support::LiveReplay;

const LandmarkSearch kLongSearch{{}, 0ms, 1h};
constexpr LiveConfig kQuick{.interval = 0ms, .landmarks_pause = 0ms};

/// Somebody who watches the session "lab", landmarks and all.
class LandmarkViewer {
public:
    explicit LandmarkViewer(LiveServer& server) : server_(server), client_(server.port()) { wish(true); }

    void wish(bool landmarks) {
        v1::LiveRequest request;
        request.set_points(true);
        request.set_landmarks(landmarks);
        client_.send(request.SerializeAsString());
    }

    template <class Condition>
    void read_until(Condition holds) {
        while (!holds()) {
            const auto message = client_.read();
            ASSERT_TRUE(message) << client_.reason();
            replay.take(*message);
        }
    }

    /// Reads until all landmarks of the whole log were received.
    void catch_up() {
        const auto revision = server_.session().snapshot()->revision;
        read_until([&] {
            const auto& received = replay.last_landmarks;
            return received.revision() >= revision && received.following() == 0;
        });
    }

    void expect_what_everybody_is_told() {
        HttpClient person(server_.port());
        person.send("GET /api/v1/sessions/lab/landmarks.geojson HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        const auto answer = boost::json::parse(person.read().body);
        const auto& features = answer.at("features").as_array();
        EXPECT_GT(features.size(), 0U);
        ASSERT_EQ(replay.landmarks.size(), features.size());
        for (const auto& feature : features) {
            const auto& received = replay.landmarks.at(feature.at("id").to_number<std::uint32_t>());
            const auto& at = feature.at("geometry").at("coordinates").as_array();
            EXPECT_NEAR(received.x(), at[0].to_number<double>(), 0.0006);
            EXPECT_NEAR(received.y(), at[1].to_number<double>(), 0.0006);
            EXPECT_EQ(received.seen(), feature.at("properties").at("seen").to_number<std::uint32_t>());
            EXPECT_EQ(received.last(), feature.at("properties").at("last").to_number<std::uint64_t>());
        }
        EXPECT_EQ(replay.last_landmarks.captures(), answer.at("captures").to_number<std::uint64_t>());
    }

    LiveReplay replay;

private:
    LiveServer& server_;
    LiveClient client_;
};

TEST(LiveLandmarks, EqualLandmarksGeoJsonWhileRobotsDrive) {
    LiveServer server(kQuick);
    server.stream("r1", 1, 40);
    LandmarkViewer viewer(server);
    viewer.catch_up();
    viewer.expect_what_everybody_is_told();
    const auto known = viewer.replay.landmarks.size();
    for (std::uint64_t seq = 41; seq <= 80; ++seq) server.stream("r1", seq, seq);
    server.stream("r2", 1, 30);
    viewer.catch_up();
    EXPECT_GT(viewer.replay.landmarks.size(), known);
    viewer.expect_what_everybody_is_told();
}

TEST(LiveLandmarks, DoNotBlockAndReachLaterViewers) {
    LiveServer server(kQuick);
    server.stream("r1", 1, 40);
    LandmarkViewer first(server);
    first.catch_up();
    LandmarkViewer second(server);
    second.catch_up();
    EXPECT_EQ(second.replay.landmarks.size(), first.replay.landmarks.size());
    second.expect_what_everybody_is_told();
}

TEST(LiveLandmarks, AreSearchedAtMostOncePerPause) {
    LiveServer server({.interval = 0ms, .landmarks_pause = 1h, .landmarks_turn = 1h});
    server.stream("r1", 1, 40);
    LandmarkViewer viewer(server);
    viewer.catch_up();
    const auto found = viewer.replay.last_landmarks.revision();
    server.stream("r1", 41, 80);
    viewer.read_until([&] { return viewer.replay.last.revision() >= server.session().snapshot()->revision; });
    EXPECT_EQ(viewer.replay.last_landmarks.revision(), found);
}

TEST(LiveLandmarks, AreNotSentWithoutSubscription) {
    LiveServer server(kQuick);
    server.stream("r1", 1, 40);
    LandmarkViewer viewer(server);
    viewer.catch_up();
    viewer.wish(false);
    viewer.wish(false);
    const auto events = viewer.replay.events;
    viewer.read_until([&] { return viewer.replay.events > events; }); // scans are sent again: the request was applied
    const auto found = viewer.replay.last_landmarks.revision();
    server.stream("r1", 41, 80);
    viewer.read_until([&] { return viewer.replay.last.revision() >= server.session().snapshot()->revision; });
    EXPECT_EQ(viewer.replay.last_landmarks.revision(), found);
}

/// What is looked for when the test says so.
class WatchedLandmarksTest : public testing::Test {
protected:
    WatchedLandmarksTest() { server_.stream("r1", 1, 40); }

    WatchedLandmarks::Look look(WatchedLandmarks& watched, LandmarkSearch search) {
        search.executor = searching_.get_executor();
        return watched.look(server_.sessions().find("lab"), server_.session().snapshot()->revision, search);
    }

    std::size_t search() {
        searching_.restart();
        return searching_.run();
    }

    LiveServer server_;
    sessions::LandmarkLayers layers_{server_.log()};
    LandmarkHub hub_{layers_};
    boost::asio::io_context searching_;
};

TEST_F(WatchedLandmarksTest, AreSharedByAllHolders) {
    const auto watched = hub_.of(7);
    EXPECT_EQ(hub_.of(7), watched);
    EXPECT_NE(hub_.of(8), watched);
}

TEST_F(WatchedLandmarksTest, AreSearchedOnceForAllViewers) {
    const auto watched = hub_.of(server_.session().info().id);
    for (int n = 0; n < 5; ++n) EXPECT_EQ(look(*watched, kLongSearch).found, nullptr);
    EXPECT_EQ(search(), 1U);
    const auto found = look(*watched, kLongSearch).found;
    ASSERT_TRUE(found);
    EXPECT_GT(found->state.landmarks.size(), 0U);
    EXPECT_EQ(found->revision, server_.session().snapshot()->revision);
    EXPECT_EQ(search(), 0U) << "nothing is new";
}

TEST_F(WatchedLandmarksTest, ContinueALongSearchInTheNextTurn) {
    server_.stream("r1", 41, 600);
    const auto watched = hub_.of(server_.session().info().id);
    const LandmarkSearch hurried{{}, 0ms, -1ms}; // over when it is first asked, after some hundred entries
    std::size_t turns = 0;
    while (!look(*watched, hurried).found) turns += search();
    EXPECT_GT(turns, 1U);
    EXPECT_EQ(look(*watched, hurried).found->revision, server_.session().snapshot()->revision);
}

TEST_F(WatchedLandmarksTest, ReportWhenToLookAgain) {
    const auto watched = hub_.of(server_.session().info().id);
    const LandmarkSearch seldom{{}, 1h, 1h};
    EXPECT_EQ(look(*watched, seldom).until, WatchedLandmarks::Clock::time_point::max()) << "a notification follows";
    EXPECT_EQ(search(), 1U);
    server_.stream("r1", 41, 41);
    const auto again = look(*watched, seldom);
    EXPECT_TRUE(again.found);
    EXPECT_GT(again.until, WatchedLandmarks::Clock::now() + 30min);
    EXPECT_LT(again.until, WatchedLandmarks::Clock::now() + 90min);
    EXPECT_EQ(search(), 0U);
}

TEST_F(WatchedLandmarksTest, KeepFoundLandmarksAfterARefusal) {
    const auto find = [&](WatchedLandmarks& watched) {
        static_cast<void>(look(watched, kLongSearch));
        EXPECT_EQ(search(), 1U);
        return look(watched, kLongSearch).found;
    };
    const std::size_t count = find(*hub_.of(0))->state.landmarks.size();
    sessions::LandmarkLayers small(server_.log(), {.size_max = count});
    LandmarkHub hub(small);
    const auto watched = hub.of(0);
    EXPECT_EQ(find(*watched)->refused, "");
    server_.stream("r1", 41, 80);
    const auto found = find(*watched);
    EXPECT_THAT(found->refused, HasSubstr("landmarks, the most that are kept"));
    EXPECT_EQ(found->state.landmarks.size(), count);
}

} // namespace
} // namespace scanloom::live
