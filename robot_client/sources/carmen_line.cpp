#include "robot_client/sources/carmen_line.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace scanloom::robot {
namespace {

using TokenSpan = std::span<const std::string_view>;

constexpr double kPi = std::numbers::pi;

std::optional<std::size_t> to_count(std::string_view token) {
    std::size_t value = 0;
    const auto [end, failed] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (end != token.data() + token.size() || failed != std::errc{}) return std::nullopt;
    return value;
}

Error malformed(std::string message) { return {Errc::kMalformed, std::move(message)}; }

Result<double> finite(std::string_view field, std::string_view token, double magnitude_max) {
    const auto value = to_number(token);
    if (!value) return malformed(fmt::format("{} is '{}', not a number", field, shown_token(token)));
    if (!std::isfinite(*value) || std::abs(*value) > magnitude_max) {
        return Error{Errc::kInvalidField, fmt::format("{} is {}; the limit is {} in each direction", field,
                                                      shown_token(token), magnitude_max)};
    }
    return *value;
}

Result<Pose2> read_pose(std::string_view field, TokenSpan triple) {
    constexpr std::array<std::string_view, 3> kAxes{"x", "y", "theta"};
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) {
        auto value = finite(fmt::format("{}_{}", field, kAxes[i]), triple[i], kCoordinateMax);
        if (!value) return value.error();
        values[i] = *value;
    }
    return Pose2{values[0], values[1], normalize_angle(values[2])};
}

/// Reads `n r1..rn` from the front of `tokens` and removes them.
Result<std::vector<RangeMm>> take_ranges(TokenSpan& tokens) {
    const auto count = tokens.empty() ? std::nullopt : to_count(tokens[0]);
    if (!count) return malformed("the number of beams is missing or not a number");
    if (*count == 0) return Error{Errc::kInvalidField, "0 beams; a scan needs at least 1"};
    if (*count > kBeamsMax) {
        return Error{Errc::kTooLarge, fmt::format("{} beams, at most {} are allowed", *count, kBeamsMax)};
    }
    if (tokens.size() - 1 < *count) {
        return malformed(fmt::format("{} beams are announced, but {} values follow", *count, tokens.size() - 1));
    }
    std::vector<RangeMm> ranges(*count);
    for (std::size_t i = 0; i < *count; ++i) {
        const auto range = to_number(tokens[1 + i]);
        if (!range) return malformed(fmt::format("range {} is '{}', not a number", i + 1, shown_token(tokens[1 + i])));
        ranges[i] = to_range_mm(*range);
    }
    tokens = tokens.subspan(1 + *count);
    return ranges;
}

/// Reads the stamp of a trailer of 3 (ipc_timestamp hostname logger_timestamp), 2 (without the first) or 0 values.
Result<std::optional<double>> read_stamp(TokenSpan trailer) {
    if (trailer.empty()) return std::optional<double>{};
    const std::string_view token = trailer.size() == 3 ? trailer[0] : trailer[1];
    auto stamp = finite("the timestamp", token, std::numeric_limits<double>::max());
    if (!stamp) return stamp.error();
    return std::optional(*stamp);
}

/// Reads the tail of a laser line: no poses or two (the laser's and the robot's), then the trailer.
/// @param robot  names the second pose in messages
Result<CarmenLine> with_tail(CarmenScan scan, TokenSpan poses, std::string_view robot, TokenSpan trailer) {
    if (!poses.empty()) {
        auto laser_pose = read_pose("laser", poses.first(3));
        if (!laser_pose) return laser_pose.error();
        auto robot_pose = read_pose(robot, poses.subspan(3, 3));
        if (!robot_pose) return robot_pose.error();
        scan.laser = *laser_pose;
        scan.robot = *robot_pose;
    }
    auto stamp = read_stamp(trailer);
    if (!stamp) return stamp.error();
    scan.stamp = *stamp;
    return CarmenLine(std::move(scan));
}

UniformAngles flaser_angles(std::size_t count) {
    const auto beams = static_cast<std::uint32_t>(count);
    if (count == 1) return {0.0, kPi / 180.0, beams};
    double increment = kPi / static_cast<double>(count - 1);
    if (count == 180 || count == 181) increment = kPi / 180.0;
    if (count == 360 || count == 361) increment = kPi / 360.0;
    return {-kPi / 2.0, increment, beams};
}

Result<CarmenLine> read_flaser(TokenSpan tokens) {
    CarmenScan scan;
    auto ranges = take_ranges(tokens);
    if (!ranges) return ranges.error();
    scan.ranges = std::move(*ranges);
    scan.angles = flaser_angles(scan.ranges.size());
    if (tokens.size() != 9 && tokens.size() != 8 && tokens.size() != 6) {
        return malformed(fmt::format("{} values follow the {} ranges; two poses and the time stamps are 9",
                                     tokens.size(), scan.ranges.size()));
    }
    return with_tail(std::move(scan), tokens.first(6), "odom", tokens.subspan(6));
}

/// Reads laser_type start_angle fov angular_resolution maximum_range accuracy remission_mode and removes them.
Result<> take_laser_head(TokenSpan& tokens, CarmenScan& scan) {
    if (tokens.size() < 7) return malformed("the line ends within the laser's parameters");
    auto start = finite("start_angle", tokens[1], 2.0 * kFullTurn);
    if (!start) return start.error();
    auto increment = finite("angular_resolution", tokens[3], kFullTurn);
    if (!increment) return increment.error();
    if (*increment == 0.0)
        return Error{Errc::kInvalidField, "angular_resolution is 0; all beams would have the same direction"};
    const auto range_max = to_number(tokens[4]);
    if (!range_max) return malformed(fmt::format("maximum_range is '{}', not a number", shown_token(tokens[4])));
    if (*range_max > 0.0) scan.range_max = *range_max;
    scan.angles = {*start, *increment, 0};
    tokens = tokens.subspan(7);
    return {};
}

Result<> check_span(const CarmenScan& scan) {
    const double span = std::abs(scan.angles.increment) * static_cast<double>(scan.ranges.size() - 1);
    if (span <= kFullTurn) return {};
    return Error{Errc::kInvalidField, fmt::format("{} beams of angular_resolution {:g} span more than a full turn",
                                                  scan.ranges.size(), scan.angles.increment)};
}

/// Parts of the tail of a laser line: the values before the poses (m and the remissions), and the trailer.
struct TailShape {
    std::size_t remissions = 0; ///< values, including their count m
    std::size_t trailer = 0;    ///< 3, 2 or 0 values
};

/// @param body_sizes  how many values may be between the remissions and the trailer
/// Tries trailers with a host name first, longest first: a host name is not a number.
std::optional<TailShape> find_shape(TokenSpan tail, std::span<const std::size_t> body_sizes) {
    for (const std::size_t trailer : {3U, 2U, 0U}) {
        if (tail.size() < trailer) continue;
        if (trailer > 0 && to_number(tail[tail.size() - 2])) continue;
        const std::size_t values = tail.size() - trailer;
        // A leading count of 0 with a time of 0 is more likely m and turn_axis of a line without ipc_timestamp.
        const bool looks_counted = trailer == 3 && tail[0] == "0" && to_number(tail[tail.size() - 3]) == 0.0;
        for (const std::size_t body : body_sizes) {
            if (values == body && !looks_counted) return TailShape{0, trailer};
        }
        const auto remissions = values == 0 ? std::nullopt : to_count(tail[0]);
        if (remissions && *remissions <= kBeamsMax && values == 1 + *remissions + body_sizes.back()) {
            return TailShape{1 + *remissions, trailer};
        }
    }
    return std::nullopt;
}

/// Counts of laser pose, robot pose, tv, rv, forward_safety_dist, side_safety_dist and, in most files, turn_axis.
constexpr std::array<std::size_t, 2> kRobotLaserBody{10, 11};
constexpr std::array<std::size_t, 1> kRawLaserBody{0};

Result<CarmenLine> read_new_laser(TokenSpan tokens, CarmenKind kind, std::uint32_t sensor) {
    CarmenScan scan;
    scan.kind = kind;
    scan.sensor = sensor;
    if (auto ok = take_laser_head(tokens, scan); !ok) return ok.error();
    auto ranges = take_ranges(tokens);
    if (!ranges) return ranges.error();
    scan.ranges = std::move(*ranges);
    scan.angles.count = static_cast<std::uint32_t>(scan.ranges.size());
    if (auto ok = check_span(scan); !ok) return ok.error();

    const bool has_poses = kind == CarmenKind::kRobotLaser;
    const auto shape = has_poses ? find_shape(tokens, kRobotLaserBody) : find_shape(tokens, kRawLaserBody);
    if (!shape) {
        return malformed(fmt::format("{} values follow the {} ranges, which fit no form of this line", tokens.size(),
                                     scan.ranges.size()));
    }
    const TokenSpan poses = has_poses ? tokens.subspan(shape->remissions, 6) : TokenSpan{};
    return with_tail(std::move(scan), poses, "robot", tokens.last(shape->trailer));
}

/// Reads x y theta tv rv accel, and a trailer with a stamp.
CarmenLine read_odometry(TokenSpan tokens) {
    if (tokens.size() != 9 && tokens.size() != 8) return {};
    const auto pose = read_pose("odom", tokens.first(3));
    const auto stamp = read_stamp(tokens.subspan(6));
    if (!pose || !stamp) return {};
    return CarmenOdometry{*pose, **stamp};
}

CarmenLine read_param(TokenSpan tokens) {
    if (tokens.size() < 2 || tokens[0] != "robot_frontlaser_offset") return {};
    const auto forward = finite("robot_frontlaser_offset", tokens[1], 100.0);
    if (!forward) return {};
    return CarmenLaserOffset{*forward};
}

constexpr std::array<std::string_view, 8> kUnreadLasers{"RLASER",    "LASER3",    "LASER4",    "LASER5",
                                                        "RAWLASER2", "RAWLASER3", "RAWLASER4", "RAWLASER5"};

Result<CarmenLine> parse_by_tag(std::string_view tag, TokenSpan rest) {
    if (tag == "FLASER") return read_flaser(rest);
    if (tag == "ROBOTLASER1") return read_new_laser(rest, CarmenKind::kRobotLaser, 0);
    if (tag == "ROBOTLASER2") return read_new_laser(rest, CarmenKind::kRobotLaser, 1);
    if (tag == "RAWLASER1") return read_new_laser(rest, CarmenKind::kRawLaser, 0);
    if (tag == "ODOM") return read_odometry(rest);
    if (tag == "PARAM") return read_param(rest);
    const auto unread = std::ranges::find(kUnreadLasers, tag);
    return unread == kUnreadLasers.end() ? CarmenLine{} : CarmenUnreadLaser{*unread};
}

} // namespace

Result<CarmenLine> parse_carmen_line(std::string_view line) {
    const Tokens tokens = split(line);
    if (tokens.empty()) return CarmenLine{};
    auto parsed = parse_by_tag(tokens[0], TokenSpan(tokens).subspan(1));
    if (!parsed) return prefixed(fmt::format("{}: ", tokens[0]), parsed.error());
    return parsed;
}

} // namespace scanloom::robot
