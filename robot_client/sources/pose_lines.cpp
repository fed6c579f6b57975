#include "robot_client/sources/pose_lines.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

namespace scanloom::robot {
namespace {

constexpr std::size_t kNumbers = 4;

/// Parses lines and collects their poses.
class Collector {
public:
    explicit Collector(const std::function<void(const SkippedLine&)>& report) : report_(report) {}

    void take(std::string_view line) {
        ++line_number_;
        const auto pose = read_pose_line(line);
        if (!pose) {
            ++lines_.skipped;
            report_({line_number_, pose.error().message});
        } else if (*pose) {
            lines_.poses.insert(**pose);
        }
    }

    [[nodiscard]] Result<PoseLines> finish(std::string_view name) && {
        if (!lines_.poses.empty()) return std::move(lines_);
        return Error{Errc::kNotFound, fmt::format("{}: no valid pose; each line must be: t x y yaw", name)};
    }

private:
    const std::function<void(const SkippedLine&)>& report_;
    std::size_t line_number_ = 0;
    PoseLines lines_;
};

} // namespace

Result<std::optional<StampedPose>> read_pose_line(std::string_view line) {
    const Tokens tokens = split(line);
    if (tokens.empty() || tokens.front().starts_with('#')) return std::optional<StampedPose>{};
    if (tokens.size() < kNumbers) {
        return Error{Errc::kMalformed, fmt::format("{} values; 4 are needed: t x y yaw", tokens.size())};
    }
    std::array<double, kNumbers> numbers{};
    for (std::size_t i = 0; i < kNumbers; ++i) {
        const auto number = to_number(tokens[i]);
        if (!number) return Error{Errc::kMalformed, fmt::format("'{}' is not a number", shown_token(tokens[i]))};
        if (!std::isfinite(*number)) {
            return Error{Errc::kInvalidField, fmt::format("'{}' is not finite", shown_token(tokens[i]))};
        }
        numbers[i] = *number;
    }
    const auto& [t, x, y, yaw] = numbers;
    if (std::max(std::abs(x), std::abs(y)) > kCoordinateMax) {
        return Error{Errc::kInvalidField, fmt::format("the pose is more than {} m from the origin", kCoordinateMax)};
    }
    return std::optional(StampedPose{{x, y, normalize_angle(yaw)}, t});
}

Result<PoseLines> read_pose_lines(const std::filesystem::path& path,
                                  const std::function<void(const SkippedLine&)>& report, LineLimits limits) {
    auto lines = LineReader::open(path, limits);
    if (!lines) return lines.error();
    Collector collector(report);
    for (;;) {
        const auto line = lines->next();
        if (!line) return line.error();
        if (!*line) return std::move(collector).finish(path.string());
        collector.take(**line);
    }
}

Result<PoseLines> read_pose_lines(std::istream& lines, std::string_view name,
                                  const std::function<void(const SkippedLine&)>& report) {
    Collector collector(report);
    for (std::string line; std::getline(lines, line);) collector.take(line);
    return std::move(collector).finish(name);
}

} // namespace scanloom::robot
