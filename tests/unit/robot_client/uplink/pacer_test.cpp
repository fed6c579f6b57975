#include "robot_client/uplink/pacer.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
constexpr Pacer::Time kStart{1000s};

TEST(Pacer, SpeedZeroIsAtOnce) {
    Pacer pacer(0.0);
    EXPECT_EQ(pacer.due(5.0, kStart), kStart);
    EXPECT_EQ(pacer.due(500.0, kStart), kStart);
}

TEST(Pacer, KeepsThePaceOfTheStampsFromTheFirstOn) {
    Pacer pacer(2.0);
    EXPECT_EQ(pacer.due(976052857.0, kStart), kStart);
    EXPECT_EQ(pacer.due(976052858.0, kStart + 10s), kStart + 500ms) << "late scans do not shift those after them";
    EXPECT_EQ(pacer.due(976052867.0, kStart + 10s), kStart + 5s);
}

} // namespace
} // namespace scanloom::robot
