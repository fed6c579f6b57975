#include "tests/unit/robot_client/uplink/client_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// A robot that requests its localization.
namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::Not;

wire::LocateRequest question() {
    wire::LocateRequest request;
    for (std::int32_t n = 0; n < 30; ++n) request.points.push_back({1000 + n, 7 * n});
    request.near = wire::Near{{2.0, 3.0}, 4.0};
    return request;
}

class Locating : public testing::Test {
protected:
    Locating() { connect(); }

    void connect() {
        client_.protocol.open("host:1", now_);
        EXPECT_EQ(client_.sent(now_).size(), 1U);
        EXPECT_FALSE(client_.receive(wire::Welcome{"a1", 0, {}, 1 << 20}, now_));
    }

    Error refused(Errc code) {
        const auto failure =
            client_.receive(wire::LinkError{{code, "a frame without a body this program knows"}, false}, now_);
        if (failure) return failure->error;
        ADD_FAILURE() << "the link continues";
        return {};
    }

    ClientLink::Time now_{std::chrono::seconds(1000)};
    ClientLink client_{client_options(), now_};
};

TEST_F(Locating, SendsTheRequestAndPassesOnTheReply) {
    std::vector<link::Reply> replies;
    const auto id = client_.protocol.ask(question(), [&](const link::Reply& reply) { replies.push_back(reply); });
    const auto messages = client_.sent(now_);
    ASSERT_EQ(messages.size(), 1U);
    auto asked = question();
    asked.id = id.value();
    EXPECT_EQ(messages[0], wire::Message(asked));
    EXPECT_TRUE(client_.receive(wire::PlanReply{*id, 1, wire::Path{}}, now_)) << "of another kind";
    const wire::LocateReply reply{*id, 9, wire::Correction{{1.0, 2.0, 3.0}, 9, 0.9, 0.01, 0.02}};
    EXPECT_FALSE(client_.receive(reply, now_));
    ASSERT_EQ(replies.size(), 1U);
    EXPECT_EQ(std::get<wire::LocateReply>(replies[0]), reply);
}

TEST_F(Locating, RequestIsSentAgainOnTheNextLink) {
    EXPECT_TRUE(client_.protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_EQ(client_.sent(now_).size(), 1U);
    client_.protocol.close();
    connect();
    EXPECT_EQ(client_.sent(now_).size(), 1U);
}

TEST_F(Locating, UnknownRequestBlamesAnEarlierServerVersion) {
    EXPECT_TRUE(client_.protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_EQ(client_.sent(now_).size(), 1U);
    EXPECT_THAT(refused(Errc::kMalformed).message,
                HasSubstr("; servers of earlier versions cannot localize robots: update the server, or give"));
    EXPECT_THAT(refused(Errc::kUnauthorized).message, Not(HasSubstr("earlier versions")));
}

TEST_F(Locating, ErrorWithoutOpenRequestBlamesNoVersion) {
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier versions"))) << "before the request";
    EXPECT_TRUE(client_.protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier versions"))) << "before it was sent";
    const auto messages = client_.sent(now_);
    const auto id = std::get<wire::LocateRequest>(messages.at(0)).id;
    EXPECT_FALSE(client_.receive(wire::LocateReply{id, 1, Error{Errc::kAmbiguous, "here or there"}}, now_));
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier versions"))) << "after its reply";
}

} // namespace
} // namespace scanloom::robot
