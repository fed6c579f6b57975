#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <array>
#include <string>
#include <string_view>

/// Poses and places as words of a command line.
namespace scanloom::robot {

/// Parses three finite numbers separated by commas.
/// @param form  what the text should be, for the error
/// Errors: kInvalidField.
[[nodiscard]] Result<std::array<double, 3>> parse_three_numbers(const std::string& text, std::string_view form);

/// Checks that a place is within kCoordinateMax of the origin. Metres.
/// Errors: kInvalidField.
[[nodiscard]] Result<> check_place(double x, double y);

/// Parses X,Y,YAW in metres and radians; the yaw is at most a full turn.
/// Errors: kInvalidField.
[[nodiscard]] Result<Pose2> parse_pose(const std::string& text);

} // namespace scanloom::robot
