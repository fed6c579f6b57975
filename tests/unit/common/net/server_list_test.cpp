#include "common/net/server_list.hpp"

#include <gtest/gtest.h>

#include <string>

namespace scanloom::net {
namespace {

class ServerListTest : public testing::Test {
protected:
    [[nodiscard]] std::string current() const { return servers_.current().text(); }

    ServerList servers_{{{"a", "1"}, {"b", "2"}, {"c", "3"}}};
};

TEST_F(ServerListTest, TheNextOneIsTriedAfterAFailure) {
    EXPECT_EQ(servers_.text(), "a:1,b:2,c:3");
    for (const char* next : {"b:2", "c:3", "a:1"}) {
        EXPECT_FALSE(servers_.choose_another(""));
        EXPECT_EQ(current(), next);
    }
    EXPECT_EQ(ServerList({{"a", "1"}, {"b", "2"}}, 5).current().text(), "b:2");
}

TEST_F(ServerListTest, AServerThatIsNamedIsTriedAtOnce) {
    EXPECT_TRUE(servers_.choose_another("x:9"));
    EXPECT_EQ(current(), "x:9");
    EXPECT_EQ(servers_.index(), std::nullopt);
    EXPECT_FALSE(servers_.choose_another("")) << "it cannot be used";
    EXPECT_EQ(servers_.wait_max(), ServerList::kShort);
    EXPECT_EQ(current(), "a:1") << "which knows by now that it cannot";
    EXPECT_EQ(servers_.index(), 0U);
    EXPECT_FALSE(servers_.choose_another("not an address"));
    EXPECT_EQ(current(), "b:2");
}

TEST_F(ServerListTest, ServersThatSendEachOtherTheClientAreNotFollowedForever) {
    int followed = 0;
    while (servers_.choose_another(followed % 2 == 0 ? "x:9" : "y:8")) ++followed;
    EXPECT_EQ(followed, ServerList::kRedirectsMax);
    EXPECT_EQ(current(), "a:1");
    ASSERT_TRUE(servers_.choose_another("x:9"));
    servers_.settle();
    EXPECT_GT(servers_.wait_max(), std::chrono::hours(1));
    for (int n = 0; n < ServerList::kRedirectsMax; ++n) EXPECT_TRUE(servers_.choose_another("y:8"));
}

} // namespace
} // namespace scanloom::net
