#include "robot_client/app/pose_text.hpp"

#include "common/scan/limits.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace scanloom::robot {

Result<std::array<double, 3>> parse_three_numbers(const std::string& text, std::string_view form) {
    std::array<double, 3> numbers{};
    const auto words = CLI::detail::split(text, ',');
    bool is_valid = words.size() == numbers.size();
    for (std::size_t i = 0; is_valid && i < numbers.size(); ++i) {
        is_valid = CLI::detail::lexical_cast(words[i], numbers[i]) && std::isfinite(numbers[i]);
    }
    if (is_valid) return numbers;
    return Error{Errc::kInvalidField, fmt::format("'{}' is not {}", text, form)};
}

Result<> check_place(double x, double y) {
    const double farthest = std::abs(x) > std::abs(y) ? x : y;
    if (std::abs(farthest) <= kCoordinateMax) return {};
    return Error{Errc::kInvalidField, fmt::format("{} m is outside the map, which extends {} m in each direction",
                                                  farthest, kCoordinateMax)};
}

Result<Pose2> parse_pose(const std::string& text) {
    const auto numbers = parse_three_numbers(text, "X,Y,YAW in metres and radians");
    if (!numbers) return numbers.error();
    const auto [x, y, yaw] = *numbers;
    if (auto ok = check_place(x, y); !ok) return ok.error();
    if (std::abs(yaw) <= 2.0 * std::numbers::pi) return Pose2{x, y, normalize_angle(yaw)};
    return Error{
        Errc::kInvalidField,
        fmt::format("yaw is in radians, and {:g} of them are more than a full turn; 90 degrees are 1.570796", yaw)};
}

} // namespace scanloom::robot
