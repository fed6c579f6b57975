#include "server/guide/first_places.hpp"

#include <gtest/gtest.h>

namespace scanloom::guide {
namespace {

using std::chrono::seconds;

constexpr FirstPlaces::Clock::time_point kStart{};

TEST(FirstPlaces, AreForOneRobotOfASessionAtATime) {
    FirstPlaces places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    EXPECT_FALSE(places.take(1, 1, kStart + seconds(29)));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(29))) << "asked again, it is told the same";
    EXPECT_TRUE(places.take(2, 1, kStart + seconds(29))) << "another session is another map";
}

TEST(FirstPlaces, AreForAnotherOnceARobotHasSentNothingForLong) {
    FirstPlaces places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(20))) << "which does not make it longer";
    EXPECT_TRUE(places.take(1, 1, kStart + seconds(30)));
    EXPECT_FALSE(places.take(1, 0, kStart + seconds(59)));
    EXPECT_TRUE(places.take(1, 0, kStart + seconds(60)));
}

TEST(FirstPlaces, OfASessionThatIsDeletedAreForgotten) {
    FirstPlaces places;
    EXPECT_TRUE(places.take(1, 0, kStart));
    places.remove(1);
    EXPECT_TRUE(places.take(1, 1, kStart));
}

} // namespace
} // namespace scanloom::guide
