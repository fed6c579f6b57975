#include "server/live/seats.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace scanloom::live {
namespace {

TEST(Seats, OutliveWhoeverGaveThem) {
    std::optional<Seats> seats(LiveConfig{});
    const auto seat = seats->try_take(1);
    seats.reset();
    EXPECT_TRUE(seat);
}

} // namespace
} // namespace scanloom::live
