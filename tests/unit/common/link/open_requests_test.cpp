#include "common/link/requests.hpp"

#include <gtest/gtest.h>

namespace scanloom::link {
namespace {

std::uint64_t id_of(const std::optional<wire::Message>& message) { return std::get<wire::PlanRequest>(*message).id; }

wire::Message no_path(std::uint64_t id) { return wire::PlanReply{id, 1, Error{Errc::kNoPath, "a wall"}}; }

const Request kPlan = wire::PlanRequest{.goal = {1.0, 2.0}};

TEST(OpenRequests, AreSentOnceInOrder) {
    OpenRequests requests;
    EXPECT_FALSE(requests.next());
    for (int n = 0; n < 2; ++n) EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
    const auto first = id_of(requests.next());
    const auto second = id_of(requests.next());
    EXPECT_LT(first, second);
    EXPECT_FALSE(requests.next());
}

TEST(OpenRequests, ExcessRequestIsRefused) {
    OpenRequests requests;
    for (std::size_t n = 0; n < OpenRequests::kMax; ++n) EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
    EXPECT_FALSE(requests.add(kPlan, [](const Reply&) {}));
    EXPECT_TRUE(requests.answer(no_path(id_of(requests.next()))));
    EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
}

TEST(OpenRequests, RepliesMatchTheirRequestsInAnyOrder) {
    OpenRequests requests;
    std::string answered;
    EXPECT_TRUE(requests.add(kPlan, [&](const Reply&) { answered += 'a'; }));
    EXPECT_TRUE(requests.add(kPlan, [&](const Reply&) { answered += 'b'; }));
    const auto first = id_of(requests.next());
    const auto second = id_of(requests.next());
    EXPECT_TRUE(requests.answer(no_path(second)));
    EXPECT_TRUE(requests.answer(no_path(first)));
    EXPECT_EQ(answered, "ba");
    EXPECT_FALSE(requests.answer(no_path(first))) << "twice";
}

TEST(OpenRequests, OnlyAReplyOfTheRightTypeIsAccepted) {
    OpenRequests requests;
    EXPECT_TRUE(requests.add(kPlan, [](const Reply&) { ADD_FAILURE(); }));
    EXPECT_FALSE(requests.answer(no_path(1))) << "it was not sent yet";
    const auto id = id_of(requests.next());
    EXPECT_FALSE(requests.answer(wire::GoalReply{id, 1, wire::Goal{}}));
    EXPECT_FALSE(requests.answer(no_path(id + 1)));
    EXPECT_FALSE(requests.answer(wire::Pong{id}));
}

TEST(OpenRequests, AreSentAgainOnANewLink) {
    OpenRequests requests;
    for (int n = 0; n < 3; ++n) EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
    const auto first = id_of(requests.next());
    const auto second = id_of(requests.next());
    EXPECT_TRUE(requests.answer(no_path(first)));
    requests.rewind();
    EXPECT_EQ(id_of(requests.next()), second);
    EXPECT_GT(id_of(requests.next()), second);
    EXPECT_FALSE(requests.next());
}

TEST(OpenRequests, AbandonedBeforeSendingIsNotSent) {
    OpenRequests requests;
    const auto left = requests.add(kPlan, [](const Reply&) { ADD_FAILURE(); });
    const auto kept = requests.add(kPlan, [](const Reply&) {});
    requests.abandon(left.value());
    EXPECT_EQ(id_of(requests.next()), kept);
    EXPECT_FALSE(requests.next());
}

TEST(OpenRequests, AbandonedAfterSendingCountsUntilItsReply) {
    OpenRequests requests;
    std::optional<std::uint64_t> left;
    for (std::size_t n = 0; n < OpenRequests::kMax; ++n) {
        left = requests.add(kPlan, [](const Reply&) { ADD_FAILURE(); });
        EXPECT_TRUE(requests.next());
    }
    requests.abandon(left.value());
    EXPECT_FALSE(requests.add(kPlan, [](const Reply&) {}));
    EXPECT_TRUE(requests.answer(no_path(*left)));
    EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
    requests.abandon(*left); // again, and too late
}

TEST(OpenRequests, AbandonedIsRemovedWithItsLink) {
    OpenRequests requests;
    const auto left = requests.add(kPlan, [](const Reply&) { ADD_FAILURE(); });
    EXPECT_TRUE(requests.next());
    requests.abandon(left.value());
    requests.rewind();
    EXPECT_FALSE(requests.next());
    for (std::size_t n = 0; n < OpenRequests::kMax; ++n) EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {}));
}

TEST(OpenRequests, CallbackMayAddARequest) {
    OpenRequests requests;
    EXPECT_TRUE(requests.add(kPlan, [&](const Reply&) { EXPECT_TRUE(requests.add(kPlan, [](const Reply&) {})); }));
    EXPECT_TRUE(requests.answer(no_path(id_of(requests.next()))));
    EXPECT_TRUE(requests.next());
}

} // namespace
} // namespace scanloom::link
