#include "common/net/server_list.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace scanloom::net {
namespace {

class ServerListTest : public testing::Test {
protected:
    [[nodiscard]] std::string current() const { return servers_.current().text(); }

    static inline const std::vector<Address> kServers{{"a", "1"}, {"b", "2"}, {"c", "3"}};

    ServerList servers_{kServers, "a"}; // a:1, c:3, b:2
};

TEST_F(ServerListTest, SessionsAreSpreadOverTheServersAndOverTheNextOnes) {
    std::map<std::string, int> sessions; // by the first two servers
    for (int session = 0; session < 6000; ++session) {
        ServerList servers(kServers, std::to_string(session));
        auto two = servers.current().text();
        static_cast<void>(servers.choose_another(""));
        two += servers.current().text();
        ++sessions[two];
    }
    EXPECT_EQ(sessions.size(), 6U);
    for (const auto& [two, count] : sessions) EXPECT_NEAR(count, 1000, 120) << two; // 4 standard deviations
}

TEST_F(ServerListTest, TheOrderOfTheListDoesNotMatter) {
    ServerList reversed({kServers.rbegin(), kServers.rend()}, "a");
    for (int tried = 0; tried < 3; ++tried) {
        EXPECT_EQ(reversed.current().text(), current());
        EXPECT_EQ(kServers[*servers_.index()].text(), current());
        EXPECT_EQ(kServers[2 - *reversed.index()].text(), current());
        static_cast<void>(reversed.choose_another(""));
        static_cast<void>(servers_.choose_another(""));
    }
}

TEST_F(ServerListTest, TheNextOneIsTriedAfterAFailure) {
    EXPECT_EQ(text_of(kServers), "a:1,b:2,c:3");
    for (int round = 0; round < 2; ++round) {
        for (const char* next : {"c:3", "b:2", "a:1"}) { // as in link_test.py
            const bool all_were_tried = current() == "b:2";
            EXPECT_EQ(servers_.choose_another(""), !all_were_tried);
            EXPECT_EQ(current(), next);
        }
    }
    EXPECT_EQ(servers_.wait_max(), ServerList::kSeveralMax);
    ServerList alone({{"a", "1"}}, "a");
    EXPECT_FALSE(alone.choose_another(""));
    EXPECT_GT(alone.wait_max(), std::chrono::hours(1));
}

TEST_F(ServerListTest, AServerThatIsNamedIsTriedAtOnce) {
    EXPECT_TRUE(servers_.choose_another("x:9"));
    EXPECT_EQ(current(), "x:9");
    EXPECT_EQ(servers_.index(), std::nullopt);
    EXPECT_FALSE(servers_.choose_another("")) << "it cannot be used";
    EXPECT_EQ(servers_.wait_max(), ServerList::kShort);
    EXPECT_EQ(current(), "a:1") << "which knows by now that it cannot";
    EXPECT_EQ(servers_.index(), 0U);
    EXPECT_TRUE(servers_.choose_another("not an address"));
    EXPECT_EQ(current(), "c:3");
}

TEST_F(ServerListTest, AServerIsGivenUpSoonIfThereAreOthers) {
    const std::chrono::seconds usual(10);
    EXPECT_EQ(servers_.connect_max(usual), ServerList::kConnectMax);
    EXPECT_EQ(servers_.unconfirmed_max(), ServerList::kUnconfirmedMax);
    const ServerList alone({{"a", "1"}}, "a");
    EXPECT_EQ(alone.connect_max(usual), usual);
    EXPECT_EQ(alone.unconfirmed_max(), std::nullopt);
}

TEST_F(ServerListTest, ServersThatSendEachOtherTheClientAreNotFollowedForever) {
    int followed = 0;
    while (servers_.choose_another(followed % 2 == 0 ? "x:9" : "y:8")) ++followed;
    EXPECT_EQ(followed, ServerList::kRedirectsMax);
    EXPECT_EQ(current(), "a:1");
    ASSERT_TRUE(servers_.choose_another("x:9"));
    servers_.settle();
    EXPECT_EQ(servers_.wait_max(), ServerList::kSeveralMax);
    for (int n = 0; n < ServerList::kRedirectsMax; ++n) EXPECT_TRUE(servers_.choose_another("y:8"));
}

} // namespace
} // namespace scanloom::net
