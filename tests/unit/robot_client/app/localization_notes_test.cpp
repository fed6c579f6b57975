#include "robot_client/app/localization_notes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LocalizationNotes, TellChangesOfTheStateOnce) {
    LocalizationNotes notes;
    const auto add = [&](LocalizationState state) { return notes.add({.state = state}); };
    EXPECT_THAT(add(LocalizationState::kTracking), IsEmpty()) << "as expected from the start";
    EXPECT_THAT(add(LocalizationState::kLost), ElementsAre(HasSubstr("has lost the robot")));
    EXPECT_THAT(add(LocalizationState::kLost), IsEmpty());
    EXPECT_THAT(add(LocalizationState::kTracking), ElementsAre(HasSubstr("has found the robot")));
    EXPECT_THAT(add(LocalizationState::kUnlocated), ElementsAre(HasSubstr("place in the map is not known yet")));
}

TEST(LocalizationNotes, TellThatTheMountIsWrongOnce) {
    LocalizationNotes notes;
    const auto add = [&](std::optional<double> error) {
        return notes.add({.state = LocalizationState::kTracking, .mount_yaw_error = error});
    };
    EXPECT_THAT(add(std::nullopt), IsEmpty());
    EXPECT_THAT(add(-3.1), ElementsAre(HasSubstr("seems to be 178 degrees too small")));
    EXPECT_THAT(add(-3.0), IsEmpty());
    EXPECT_THAT(add(std::nullopt), IsEmpty());
    EXPECT_THAT(add(1.57), ElementsAre(HasSubstr("seems to be 90 degrees too large"))) << "another mount that is wrong";
}

} // namespace
} // namespace scanloom::robot
