#include "tests/unit/robot_client/uplink/client_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// A robot that asks where it is.
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
    Locating() {
        link::ClientProtocolOptions options;
        options.hello.robot = "r1";
        options.hello.session = "s1";
        client_.emplace(options, now_);
        connect();
    }

    void connect() {
        client_->protocol.open(now_);
        EXPECT_EQ(said().size(), 1U);
        EXPECT_FALSE(client_->receive(wire::Welcome{"a1", 0, {}, 1 << 20}, now_));
    }

    std::vector<wire::Message> said() {
        std::vector<wire::Message> messages;
        while (auto frame = client_->next_frame(now_)) {
            messages.push_back(*wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes)));
        }
        return messages;
    }

    Error refused(Errc code) {
        const auto failure =
            client_->receive(wire::LinkError{{code, "a frame without a body this program knows"}, false}, now_);
        if (failure) return failure->error;
        ADD_FAILURE() << "the link goes on";
        return {};
    }

    ClientLink::Time now_{std::chrono::seconds(1000)};
    std::optional<ClientLink> client_;
};

TEST_F(Locating, AsksAndHandsOverTheReply) {
    std::vector<link::Reply> replies;
    const auto id = client_->protocol.ask(question(), [&](const link::Reply& reply) { replies.push_back(reply); });
    const auto messages = said();
    ASSERT_EQ(messages.size(), 1U);
    auto asked = question();
    asked.id = id.value();
    EXPECT_EQ(messages[0], wire::Message(asked));
    EXPECT_TRUE(client_->receive(wire::PlanReply{*id, 1, wire::Path{}}, now_)) << "of another kind";
    const wire::LocateReply reply{*id, 9, wire::Correction{{1.0, 2.0, 3.0}, 9, 0.9, 0.01, 0.02}};
    EXPECT_FALSE(client_->receive(reply, now_));
    ASSERT_EQ(replies.size(), 1U);
    EXPECT_EQ(std::get<wire::LocateReply>(replies[0]), reply);
}

TEST_F(Locating, AsksAgainOnTheNextLink) {
    EXPECT_TRUE(client_->protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_EQ(said().size(), 1U);
    client_->protocol.close();
    connect();
    EXPECT_EQ(said().size(), 1U);
}

TEST_F(Locating, AServerThatDoesNotKnowTheQuestionIsCalledAnEarlierOne) {
    EXPECT_TRUE(client_->protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_EQ(said().size(), 1U);
    EXPECT_THAT(refused(Errc::kMalformed).message,
                HasSubstr("; a server of an earlier version cannot tell a robot where it is: update it, or say"));
    EXPECT_THAT(refused(Errc::kUnauthorized).message, Not(HasSubstr("earlier version")));
}

TEST_F(Locating, OfAServerThatWasNotAskedNothingIsGuessed) {
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier version"))) << "before the question";
    EXPECT_TRUE(client_->protocol.ask(question(), [](const link::Reply&) {}));
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier version"))) << "before it was sent";
    const auto messages = said();
    const auto id = std::get<wire::LocateRequest>(messages.at(0)).id;
    EXPECT_FALSE(client_->receive(wire::LocateReply{id, 1, Error{Errc::kAmbiguous, "here or there"}}, now_));
    EXPECT_THAT(refused(Errc::kMalformed).message, Not(HasSubstr("earlier version"))) << "after it was answered";
}

} // namespace
} // namespace scanloom::robot
