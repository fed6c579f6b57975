#include "server/guidance/locator.hpp"

#include <gtest/gtest.h>

namespace scanloom::guidance {
namespace {

using std::chrono::seconds;

constexpr MapStart::Clock::time_point kStart{};

TEST(MapStart, AreGrantedToOneRobotPerSession) {
    MapStart places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    EXPECT_FALSE(places.take(1, 1, kStart + seconds(29)));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(29))) << "a repeated request gets the same answer";
    EXPECT_TRUE(places.take(2, 1, kStart + seconds(29))) << "each session has its own map";
}

TEST(MapStart, AreGrantedToAnotherRobotAfterTheTerm) {
    MapStart places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(20))) << "a repeated request does not extend the term";
    EXPECT_TRUE(places.take(1, 1, kStart + seconds(30)));
    EXPECT_FALSE(places.take(1, 0, kStart + seconds(59)));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(60)));
}

TEST(MapStart, AreReleasedWhenTheSessionIsRemoved) {
    MapStart places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    places.remove(1);
    EXPECT_TRUE(places.take(1, 1, kStart));
}

} // namespace
} // namespace scanloom::guidance
