#include "tests/integration/robot_client/client_fixture.hpp"

#include <atomic>
#include <future>

/// Requests of a robot's own program.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ClientQuestions : public ClientFixture {};

TEST_F(ClientQuestions, ReturnTheServersAnswers) {
    serve();
    const auto client = Client::start(options()).value();
    send(*client, 1, 5);
    const auto goal = client->next_goal(20s);
    ASSERT_TRUE(goal) << goal.error().message;
    ASSERT_EQ(goal->outcome, ExplorationGoal::Outcome::kGoal);
    EXPECT_FALSE(goal->path.empty());
    EXPECT_EQ(goal->given_up, 0U);
    const auto path = client->plan({1.0, 0.0}, 20s);
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_LT(norm(path->points.back() - Point2{1.0, 0.0}), 0.2);
    EXPECT_GE(path->length, 0.8);
    EXPECT_GE(path->cost, path->length);
    EXPECT_GT(path->revision, 0U);
    EXPECT_EQ(client->plan({50.0, 0.0}, 20s).error().code, Errc::kNoPath);
}

TEST_F(ClientQuestions, WaitForEarlierScans) {
    serve();
    for (const auto* session : {"planned", "covered"}) {
        const auto client = Client::start(options(session)).value();
        send(*client, 1, 5);
        const bool plans = std::string_view(session) == "planned";
        const auto failed = plans ? client->plan({1.0, 0.0}, 20s).has_error() : client->coverage(20s).has_error();
        EXPECT_FALSE(failed) << session;
    }
}

TEST_F(ClientQuestions, PassTheGivenOptions) {
    serve();
    const auto client = Client::start(options()).value();
    send(*client, 1, 5);
    const auto from = client->plan({1.0, 0.0}, 20s, {.start = Point2{0.5, 0.0}});
    ASSERT_TRUE(from) << from.error().message;
    EXPECT_LT(norm(from->points.front() - Point2{0.5, 0.0}), 0.2);
    EXPECT_FALSE(client->plan({-2.0, 0.0}, 20s)) << "the goal is in unknown ground";
    EXPECT_TRUE(client->plan({-2.0, 0.0}, 20s, {.allow_unknown = true}));
    EXPECT_THAT(client->plan({1.0, 0.0}, 20s, {.danger_cost = -1.0}).error().message, HasSubstr("danger_cost"));
    const auto covered = client->coverage(20s, {.region = {{0.3, -0.3}, {1.0, -0.3}, {1.0, 0.3}, {0.3, 0.3}}});
    ASSERT_TRUE(covered) << covered.error().message;
    EXPECT_FALSE(covered->path.points.empty());
    EXPECT_NEAR(covered->free_area, 0.42, 0.1);
    EXPECT_GT(covered->covered_area, 0.0);
    EXPECT_EQ(covered->cell_size, 0.1);
}

TEST_F(ClientQuestions, RefuseInvalidArgumentsByName) {
    serve();
    const auto client = Client::start(options()).value();
    send(*client, 1, 5);
    const auto refused = [&](const auto& answer, Errc code, const char* message) {
        ASSERT_FALSE(answer);
        EXPECT_EQ(answer.error().code, code);
        EXPECT_THAT(answer.error().message, HasSubstr(message));
    };
    refused(client->plan({kNan, 1.0}, 20s), Errc::kInvalidField, "goal.x is nan");
    refused(client->plan({0.0, 1e300}, 20s), Errc::kInvalidField, "goal.y is 1e+300");
    refused(client->plan({0.0, 1.0}, 20s, {.start = Point2{kNan, 0.0}}), Errc::kInvalidField, "start.x is nan");
    refused(client->coverage(20s, {.start = Point2{2e6, 0.0}}), Errc::kInvalidField, "start.x is 2000000");
    refused(client->coverage(20s, {.region = {{0.0, kNan}}}), Errc::kInvalidField, "region[1] is nan");
    refused(client->coverage(20s, {.region = std::vector<Point2>(4097, Point2{0.0, 0.0})}), Errc::kTooLarge,
            "region has 4097 corners");
    refused(client->plan({1.0, 0.0}, 20s, {.body_radius = kNan}), Errc::kInvalidField, "body_radius");
    refused(client->coverage(20s, {.spacing = kNan}), Errc::kInvalidField, "spacing");
    EXPECT_TRUE(client->plan({1.0, 0.0}, 20s));
    EXPECT_TRUE(client->close(20s));
}

TEST_F(ClientQuestions, FromManyThreadsAreQueued) {
    serve();
    const auto client = Client::start(options()).value();
    send(*client, 1, 5);
    std::atomic<int> answered = 0;
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 16; ++thread) {
        threads.emplace_back([&] {
            const auto path = client->plan({1.0, 0.0}, 20s);
            EXPECT_TRUE(path) << path.error().message;
            answered += path ? 1 : 0;
        });
    }
    threads.clear();
    EXPECT_EQ(answered, 16);
}

TEST_F(ClientQuestions, AreDroppedWhenTheirCallerTimesOut) {
    ServerInTheTest server;
    auto made = options();
    made.server = server.address();
    const auto client = Client::start(made).value();
    for (int n = 0; n < 10; ++n) EXPECT_EQ(client->plan({1.0, 0.0}, 1ms).error().code, Errc::kTimeout);
    server.run();
    const auto path = client->plan({2.0, 0.0}, 20s);
    EXPECT_TRUE(path) << path.error().message;
    EXPECT_TRUE(client->close(20s));
    ASSERT_EQ(server.fake().plans().size(), 1U);
    EXPECT_EQ(server.fake().plans()[0].goal, (Point2{2.0, 0.0}));
}

} // namespace
} // namespace scanloom::robot
