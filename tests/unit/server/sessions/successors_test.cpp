#include "server/sessions/successors.hpp"

#include <gtest/gtest.h>

#include <map>

namespace scanloom::sessions {
namespace {

store::Node node(const std::string& name, std::size_t sessions, bool is_alive = true, bool is_self = false,
                 const std::string& robots = "host:7447") {
    return {.info = std::make_shared<const store::NodeInfo>(store::NodeInfo{.name = name, .robots = robots}),
            .is_alive = is_alive,
            .is_self = is_self,
            .sessions = sessions};
}

TEST(Successors, SessionsGoToTheServersThatHaveTheFewest) {
    std::vector<std::string> sessions;
    for (int n = 0; n < 10; ++n) sessions.push_back(std::to_string(n));
    Successors successors;
    successors.choose(sessions, {node("a", 10, true, true), node("b", 7), node("c", 0), node("dead", 0, false),
                                 node("starting", 0, true, false, "")});
    std::map<std::string, std::size_t> count{{"b", 7}};
    for (const auto& session : sessions) ++count[successors.of(session)->name];
    EXPECT_EQ(count, (std::map<std::string, std::size_t>{{"b", 9}, {"c", 8}}));
    EXPECT_EQ(successors.of("unknown"), nullptr);
}

TEST(Successors, WithoutAnotherServerThereAreNone) {
    Successors successors;
    successors.choose({"s"}, {node("a", 1, true, true), node("dead", 0, false)});
    EXPECT_EQ(successors.of("s"), nullptr);
}

} // namespace
} // namespace scanloom::sessions
