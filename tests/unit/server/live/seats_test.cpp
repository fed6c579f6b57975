#include "server/live/seats.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace scanloom::live {
namespace {

TEST(Seats, AreBoundedInAllAndOfOneSession) {
    const Seats seats({.viewers_max = 3, .viewers_per_session_max = 2});
    const auto first = seats.try_take(1);
    auto second = seats.try_take(1);
    EXPECT_TRUE(first && second);
    EXPECT_FALSE(seats.try_take(1));
    const auto other = seats.try_take(2);
    EXPECT_TRUE(other);
    EXPECT_FALSE(seats.try_take(3)) << "none is left in all";
    second.reset();
    EXPECT_TRUE(seats.try_take(1)) << "a seat comes back";
}

TEST(Seats, OutliveWhoeverGaveThem) {
    std::optional<Seats> seats(LiveConfig{});
    const auto seat = seats->try_take(1);
    seats.reset();
    EXPECT_TRUE(seat);
}

} // namespace
} // namespace scanloom::live
