#include "tests/integration/requests_fixture.hpp"

#include <string_view>
#include <thread>
#include <variant>

/// Requests that wait for others.
namespace scanloom::ingest {
namespace {

class RequestQueueTest : public RequestsTest {};

TEST_F(RequestQueueTest, ScansAreAcknowledgedDuringASearch) {
    start();
    const auto robot = looking_around("r");
    auto go_on = hold_searches();
    robot->send(plan_to({2.5, 0.2}));
    robot->send(wire::ScanBatch{{scan_with_a_gap(2)}});
    robot->wait_for_ack(2);
    robot->send(wire::Ping{9});
    EXPECT_EQ(robot->receive_kind<wire::Pong>().nonce, 9U);
    go_on.set_value();
    EXPECT_TRUE(robot->receive_kind<wire::PlanReply>().result);
}

TEST_F(RequestQueueTest, ARequestBeyondTheLimitIsRefusedAndTheOthersAreAnswered) {
    start();
    const auto robot = looking_around("r");
    auto go_on = hold_searches();
    for (std::uint64_t id = 1; id <= 5; ++id) robot->send(plan_to({2.5, 0.2}, id));
    const auto refused = robot->receive_kind<wire::PlanReply>();
    EXPECT_EQ(refused.id, 5U);
    EXPECT_EQ(refused.result.error().code, Errc::kOverloaded);
    EXPECT_THAT(refused.result.error().message, testing::StartsWith("4 requests are under way"));
    go_on.set_value();
    for (std::uint64_t id = 1; id <= 4; ++id) {
        const auto reply = robot->receive_kind<wire::PlanReply>();
        EXPECT_EQ(reply.id, id);
        EXPECT_TRUE(reply.result);
    }
    robot->send(plan_to({2.5, 0.2}, 6));
    EXPECT_TRUE(robot->receive_kind<wire::PlanReply>().result);
}

TEST_F(RequestQueueTest, ARequestBeyondTheLimitOfAllLinksIsRefused) {
    running_ = std::make_unique<RunningIngest>(log_, IngestConfig{}, 2);
    const auto first = looking_around("a");
    const auto second = looking_around("b");
    auto go_on = hold_searches();
    first->send(plan_to({2.5, 0.2}, 1));
    first->send(plan_to({2.5, 0.2}, 2));
    first->send(wire::Ping{1});
    first->receive_kind<wire::Pong>();
    second->send(wire::GoalRequest{.id = 3});
    const auto refused = second->receive_kind<wire::GoalReply>();
    EXPECT_EQ(refused.id, 3U);
    EXPECT_EQ(refused.result.error().code, Errc::kOverloaded);
    go_on.set_value();
    EXPECT_TRUE(first->receive_kind<wire::PlanReply>().result);
    EXPECT_TRUE(first->receive_kind<wire::PlanReply>().result);
}

TEST_F(RequestQueueTest, AGoodbyeWaitsForReplies) {
    start();
    const auto robot = looking_around("r");
    auto go_on = hold_searches();
    robot->send_bytes(frame_of(plan_to({2.5, 0.2}, 8)) + frame_of(wire::Goodbye{"done"}));
    go_on.set_value();
    EXPECT_TRUE(robot->receive_kind<wire::PlanReply>().result);
    EXPECT_FALSE(robot->receive().has_value());
}

TEST_F(RequestQueueTest, ARobotThatLeavesBeforeItsReplyDisturbsNoOtherRobot) {
    start();
    const auto other = looking_around("other");
    auto go_on = hold_searches();
    {
        const auto robot = looking_around("r");
        robot->send(plan_to({2.5, 0.2}));
        robot->send(wire::Ping{1});
        robot->receive_kind<wire::Pong>();
        robot->reset();
    }
    other->send(plan_to({2.5, 0.2}));
    go_on.set_value();
    EXPECT_TRUE(other->receive_kind<wire::PlanReply>().result);
}

TEST_F(RequestQueueTest, UnreadRefusalsEndTheLink) {
    start();
    const auto robot = looking_around("r");
    auto go_on = hold_searches();
    std::string many;
    while (many.size() < std::size_t{16} << 20) wire::encode(plan_to({2.5, 0.2}), many);
    std::thread sending([&] {
        try {
            robot->send_bytes(many);
        } catch (const boost::system::system_error&) { // disconnected meanwhile
        }
    });
    sending.join();
    go_on.set_value();
    bool ended = false;
    try {
        while (const auto message = robot->receive()) {
            if (const auto* error = std::get_if<wire::LinkError>(&*message)) {
                EXPECT_EQ(error->error.code, Errc::kCreditExceeded) << error->error.message;
                ended = true;
            }
        }
    } catch (const boost::system::system_error& error) { // requests that the server had not read
        EXPECT_EQ(error.code(), boost::asio::error::connection_reset);
        ended = true;
    }
    EXPECT_TRUE(ended);
}

TEST_F(RequestQueueTest, NoSearchStartsDuringShutdown) {
    auto& ingest = start();
    const auto robot = looking_around("r");
    const auto session = ingest.sessions().find("lab");
    auto go_on = hold_searches();
    std::promise<std::string> sent;
    guidance::GoalAssignments goals;
    RequestExecutor requests(ingest.planning(), ingest.planning(), {goals, ingest.locator(), ingest.sessions()});
    ASSERT_FALSE(
        requests.submit({session, 0}, plan_to({2.5, 0.2}),
                        [&](std::string frame, const std::shared_ptr<const void>&) { sent.set_value(frame); }));
    std::thread draining([&] { ingest.sessions().drain(); });
    draining.join();
    go_on.set_value();
    const auto frame = sent.get_future().get();
    const auto reply = wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes)).value();
    EXPECT_EQ(std::get<wire::PlanReply>(reply).result.error().code, Errc::kShuttingDown);
}

} // namespace
} // namespace scanloom::ingest
