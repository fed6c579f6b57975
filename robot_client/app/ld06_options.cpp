#include "robot_client/app/ld06_options.hpp"

#include "common/app/command_line.hpp"
#include "common/net/connect.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/app/pose_text.hpp"
#include "robot_client/sources/stationary_detector.hpp"
#include "robot_client/uplink/limits.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace scanloom::robot {
namespace {

Result<wire::Near> parse_near(const std::string& text) {
    const auto numbers = parse_three_numbers(text, "X,Y,RADIUS in metres");
    if (!numbers) return numbers.error();
    const auto [x, y, radius] = *numbers;
    if (auto ok = check_place(x, y); !ok) return ok.error();
    if (radius >= kNearRadiusMin && radius <= kNearRadiusMax) return wire::Near{{x, y}, radius};
    return Error{Errc::kInvalidField, fmt::format("the radius {:g} m is out of range: {:g} to {:g}", radius,
                                                  kNearRadiusMin, kNearRadiusMax)};
}

std::string check_window(const std::string& text) {
    int window = 0;
    if (CLI::detail::lexical_cast(text, window) && window % 2 == 1 && window >= kMedianWindowMin &&
        window <= kMedianWindowMax) {
        return {};
    }
    return fmt::format("'{}' is not an odd number from {} to {}", text, kMedianWindowMin, kMedianWindowMax);
}

std::string check_confidence(const std::string& text) {
    int confidence = 0;
    if (CLI::detail::lexical_cast(text, confidence) && confidence >= 0 && confidence <= 255) return {};
    return fmt::format("'{}' is not a whole number from 0 to 255", text);
}

void add_poses(CLI::App& ld06, Ld06Options& options) {
    add_parsed(
        ld06, "--pose", options.pose,
        "X,Y,YAW of a stationary robot: metres, and radians counter-clockwise. With --locate: its first pose, used "
        "if no map exists yet; default then: 0,0,0",
        parse_pose);
    ld06.add_option("--pose-file", options.pose_file,
                    "File of lines: t x y yaw, '-' = stdin: poses in the map, or odometry with --poses odometry. t is "
                    "seconds since the first packet for a file, and Unix time for a "
                    "device. Poses are interpolated; scans before the first and after the last line are skipped");
    add_parsed(ld06, "--mount", options.mount,
               "X,Y,YAW of the sensor on the robot; its 0 degrees are its x axis. Default: 0,0,0", parse_pose);
}

void add_locating(CLI::App& ld06, Ld06Options& options) {
    ld06.add_flag(
        "--locate", options.locate,
        "Deprecated, until 0.4: use --poses none. For a lidar that is carried from place to place: the server "
        "localizes it where it stands. Scans taken while it moves are dropped. Each run sends a capture file "
        "again");
    add_parsed(ld06, "--near", options.near,
               "X,Y,RADIUS in metres, with --locate: the maximum distance of the first place from X,Y along each axis; "
               "later places are at most 100 m apart. Default: anywhere in the map",
               parse_near);
}

/// Returns why the options for the robot's place are invalid, or an empty string.
std::string complaint_about_places(const Ld06Options& options, Poses poses) {
    if (options.near && !options.locate) return "ld06: --near needs --locate; give both, or neither";
    if (options.locate && poses != Poses::kMap) {
        return fmt::format("ld06: --locate sends poses in the map, and --poses {} sends none; leave one of them out",
                           name_of(poses));
    }
    if (options.locate && !options.pose_file.empty()) {
        return "ld06: --locate requests the pose from the server, and --pose-file states it; leave one of them out";
    }
    if (options.locate && options.speed > 0.0) {
        return "ld06: with --locate a capture file is read as fast as the server accepts scans; leave --speed out";
    }
    if (poses == Poses::kNone && (options.pose || !options.pose_file.empty())) {
        return "ld06: with --poses none no poses are sent; leave --pose and --pose-file out";
    }
    if (poses == Poses::kOdometry && (options.pose || options.pose_file.empty())) {
        return "ld06: --poses odometry needs the odometry; give it with --pose-file FILE, and leave --pose out";
    }
    if (poses == Poses::kMap && !options.locate && options.pose.has_value() != options.pose_file.empty()) {
        return "ld06: state the robot's pose with --pose X,Y,YAW or --pose-file FILE, let the server estimate it with "
               "--poses none, or let the server determine it with --locate";
    }
    return {};
}

} // namespace

CLI::App* add_ld06(CLI::App& app, Ld06Options& options) {
    auto* ld06 = app.add_subcommand("ld06", "Read an LD06 or LD19 lidar, or a file with its bytes");
    ld06->add_option("INPUT", options.input, "Serial device (/dev/ttyUSB0), tcp://HOST:PORT (ser2net), or capture file")
        ->configurable(false);
    add_poses(*ld06, options);
    add_locating(*ld06, options);
    ld06->add_option("--min-range", options.range_min, "Metres; shorter readings are invalid. Default: 0.02")
        ->check(check_within(0.0, kRangeMax));
    ld06->add_option("--min-confidence", options.confidence_min, "0 to 255; readings below are invalid. Default: 100")
        ->check(check_confidence);
    ld06->add_option("--median", options.median_window,
                     "Beams; each reading becomes the median of this many neighbours. Odd, 3 to 101; from about 15 "
                     "corners are rounded. Default: off")
        ->check(check_window);
    add_checked(*ld06, "--speed", options.speed,
                "For a capture file: 1 = as recorded, 0 = as fast as the server accepts scans", check_not_negative);
    add_checked(*ld06, "--reopen-for", options.reopen_for,
                "Seconds during which a lost device is reopened; 0 = not at all", check_within(0.0, 1e6));
    return ld06;
}

std::string complaint_about(const Ld06Options& options, Poses poses) {
    if (options.input.empty()) return "ld06: name the INPUT: a serial device, tcp://HOST:PORT, or a capture file";
    if (options.input.starts_with(kTcpScheme) && !net::parse_address(options.input.substr(kTcpScheme.size()))) {
        return fmt::format("ld06: '{}' is not tcp://HOST:PORT", options.input);
    }
    return complaint_about_places(options, poses);
}

} // namespace scanloom::robot
